//! Why a world file was refused.

use std::fmt;
use std::path::{Path, PathBuf};

use crate::{FieldError, SimError};

/// The refusal of a world file: which file, where in it, and why.
#[derive(Debug, Clone, PartialEq)]
pub struct FileError {
    /// The file; empty if bytes were read that came from none.
    pub path: PathBuf,
    /// The place within: the line and the names of what is there; may be empty.
    pub place: String,
    /// What is wrong there.
    pub problem: Box<FileProblem>,
}

/// What can be wrong with a world file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FileProblem {
    /// The file is missing, a folder, or forbidden.
    #[error("cannot be read: {0}")]
    Unreadable(String),
    /// The disk is full, the folder missing or forbidden.
    #[error("cannot be written: {0}")]
    Unwritable(String),
    /// Larger than the spec allows.
    #[error("{bytes} bytes: must be at most {most} bytes (max_bytes)")]
    TooLarge {
        /// Its size, bytes.
        bytes: u64,
        /// What is allowed, bytes.
        most: u64,
    },
    /// An ending that tells no kind of world file.
    #[error("no world file: its ending must be .world or .sdf (SDF), .yaml or .yml (map_server)")]
    UnknownKind,
    /// Broken syntax or a broken picture.
    #[error("no well-formed {format}: {message}")]
    Malformed {
        /// What it should be.
        format: &'static str,
        /// What the parser says.
        message: String,
    },
    /// Something that must be there is not.
    #[error("<{0}> is missing")]
    Missing(String),
    /// A value outside what is allowed.
    #[error(transparent)]
    Value(#[from] FieldError),
    /// What a plane world cannot represent, each by its name.
    #[error("cannot represent {}; `unsupported = \"ignore\"` leaves it out", .0.join("; "))]
    Unsupported(Vec<String>),
    /// A world that its parts do not make.
    #[error(transparent)]
    World(#[from] SimError),
}

impl FileError {
    /// A problem at a place of a file yet to be named.
    pub(super) fn at(place: impl Into<String>, problem: impl Into<FileProblem>) -> Self {
        Self { path: PathBuf::new(), place: place.into(), problem: Box::new(problem.into()) }
    }

    /// Broken syntax.
    pub(super) fn malformed(place: impl Into<String>, format: &'static str, message: impl ToString) -> Self {
        Self::at(place, FileProblem::Malformed { format, message: message.to_string() })
    }

    /// The same refusal with its file, unless it names one already.
    #[must_use]
    pub(super) fn in_file(mut self, path: &Path) -> Self {
        if self.path.as_os_str().is_empty() {
            self.path = path.to_owned();
        }
        self
    }
}

impl std::error::Error for FileError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&*self.problem)
    }
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.path.as_os_str().is_empty() {
            write!(f, "{}: ", self.path.display())?;
        }
        if !self.place.is_empty() {
            write!(f, "{}: ", self.place)?;
        }
        write!(f, "{}", self.problem)
    }
}

/// A text from a file as it may stand in a message: of bounded length, on one line.
pub(super) fn quoted(text: &str) -> String {
    const MOST: usize = 60;
    let mut chars = text.chars().map(|c| if c.is_control() { ' ' } else { c });
    let short: String = chars.by_ref().take(MOST).collect();
    if chars.next().is_some() { format!("'{short}...'") } else { format!("'{short}'") }
}
