//! What can go wrong with a results folder.

use std::io;
use std::path::{Path, PathBuf};

use crate::error::Error;

/// What can go wrong with a results folder.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// The operating system refused something.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// What was tried, as in "cannot ...".
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The reason.
        source: io::Error,
    },
    /// Another process writes to the folder.
    #[error(
        "the results folder `{}` is in use by another process; wait for it to end, or give another folder",
        folder.display()
    )]
    InUse {
        /// The results folder.
        folder: PathBuf,
    },
    /// There is no such folder.
    #[error("there is no folder `{}`", folder.display())]
    NoFolder {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder holds no index: it is no results folder, or nothing was run yet.
    #[error("`{}` holds no results: there is no index.json in it", folder.display())]
    NoIndex {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder holds the results of another grid.
    #[error("the results folder `{}` holds the grid `{held}`; give another folder for `{given}`", folder.display())]
    OtherGrid {
        /// The results folder.
        folder: PathBuf,
        /// The name of the grid in it.
        held: String,
        /// The name of the grid that was to be written.
        given: String,
    },
    /// A file is not what this version writes.
    #[error("{}: cannot read this file: {message}", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        message: String,
    },
    /// A value cannot be written down.
    #[error("{}: cannot write this: {message}", path.display())]
    Serialise {
        /// The file, or what the value is.
        path: PathBuf,
        /// What is wrong with the value.
        message: String,
    },
}

impl StoreError {
    /// The damage of a file that is not what this version writes; the error itself if it is another.
    pub(crate) fn into_damage(self) -> Result<String, Self> {
        match self {
            Self::Parse { path, message } => Ok(damage(&path, &message)),
            other => Err(other),
        }
    }
}

/// The line on a file or folder that is not what was written.
pub(crate) fn damage(path: &Path, what: &str) -> String {
    format!("`{}` is damaged: {what}; `experiments run` will redo it", path.display())
}

impl From<StoreError> for Error {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::Io { action, path, source } => Self::Io { action, path, source },
            StoreError::Serialise { .. } => Self::Failure(Box::new(error)),
            _ => Self::Input(error.to_string()),
        }
    }
}

/// Turns an I/O error into one that says what was tried, and where.
pub(super) fn at(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> StoreError {
    let path = path.to_owned();
    move |source| StoreError::Io { action, path, source }
}

/// Turns the error of a deserialiser into one that names the file.
pub(super) fn unreadable<E: ToString>(path: &Path) -> impl FnOnce(E) -> StoreError {
    let path = path.to_owned();
    move |error| StoreError::Parse { path, message: error.to_string() }
}

/// Turns the error of a serialiser into one that names the file.
pub(super) fn unserialisable<E: ToString>(path: &Path) -> impl FnOnce(E) -> StoreError {
    let path = path.to_owned();
    move |error| StoreError::Serialise { path, message: error.to_string() }
}
