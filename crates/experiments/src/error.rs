//! The crate's error: what went wrong, and whether the user's input or the machine is to blame.

use std::path::{Path, PathBuf};

use crate::spec::SpecError;

/// What a subcommand failed with; its [`exit_code`](Error::exit_code) tells bad input from trouble on the way.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A spec file, or an override of one, is wrong.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// Another input is wrong: a folder without records, a policy that does not fit.
    #[error("{0}")]
    Input(String),
    /// The file system refused.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// What was tried, as a verb: "read", "create the folder".
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// What the system answered.
        source: std::io::Error,
    },
    /// One run of several failed, or the scenarios that runs share.
    #[error("{source} ({run})")]
    Run {
        /// The run: its cell, its seed and its folder; or the evaluation world.
        run: String,
        /// What it failed with.
        source: Box<Error>,
    },
    /// Anything else: the run itself failed.
    #[error(transparent)]
    Failure(Box<dyn std::error::Error + Send + Sync>),
}

impl Error {
    /// An [`Error::Io`] for `path`; `action` is a verb, as in "cannot {action}".
    pub fn io(action: &'static str, path: &Path, source: std::io::Error) -> Self {
        Self::Io { action, path: path.to_owned(), source }
    }

    /// An [`Error::Failure`].
    pub fn failure(error: impl std::error::Error + Send + Sync + 'static) -> Self {
        Self::Failure(Box::new(error))
    }

    /// The process's exit code: 2 where the user can repair the input, 1 otherwise.
    ///
    /// ```
    /// use headway_experiments::Error;
    /// assert_eq!(Error::Input("results/: no finished run here".into()).exit_code(), 2);
    /// ```
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Spec(_) | Self::Input(_) => 2,
            Self::Io { source, .. } if is_input(source) => 2,
            Self::Run { source, .. } => source.exit_code(),
            Self::Io { .. } | Self::Failure(_) => 1,
        }
    }
}

/// Whether naming another path would have helped: it is missing, closed to us, or of the wrong kind.
fn is_input(source: &std::io::Error) -> bool {
    use std::io::ErrorKind as Kind;
    matches!(
        source.kind(),
        Kind::NotFound
            | Kind::PermissionDenied
            | Kind::NotADirectory
            | Kind::IsADirectory
            | Kind::ReadOnlyFilesystem
            | Kind::AlreadyExists
    )
}
