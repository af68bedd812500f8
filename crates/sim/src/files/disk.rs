//! Bytes from and to the disk.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::{FileError, FileProblem};

/// The kinds of world files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Sdf,
    Map,
}

impl Kind {
    /// The kind that a file's ending tells.
    pub(super) fn of(path: &Path) -> Result<Self, FileError> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match ending.as_str() {
            "world" | "sdf" => Ok(Self::Sdf),
            "yaml" | "yml" => Ok(Self::Map),
            _ => Err(FileError::at("", FileProblem::UnknownKind).in_file(path)),
        }
    }
}

/// A whole file, if it is of no more than `most` bytes: neither its size nor its content is trusted.
pub(super) fn read(path: &Path, most: u64) -> Result<Vec<u8>, FileError> {
    let refuse = |problem| FileError::at("", problem).in_file(path);
    let failed = |e: std::io::Error| refuse(FileProblem::Unreadable(e.to_string()));
    let meta = std::fs::metadata(path).map_err(failed)?;
    if !meta.is_file() {
        return Err(refuse(FileProblem::Unreadable("not a file".into())));
    }
    if meta.len() > most {
        return Err(refuse(FileProblem::TooLarge { bytes: meta.len(), most }));
    }
    let mut bytes = Vec::new();
    File::open(path).map_err(failed)?.take(most.saturating_add(1)).read_to_end(&mut bytes).map_err(failed)?;
    let n = bytes.len() as u64;
    if n > most { Err(refuse(FileProblem::TooLarge { bytes: n, most })) } else { Ok(bytes) }
}

pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let failed = |e: std::io::Error| FileError::at("", FileProblem::Unwritable(e.to_string())).in_file(path);
    std::fs::write(path, bytes).map_err(failed)
}

/// A file that another one names, seen from that one's folder.
pub(super) fn beside(path: &Path, name: &str) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).join(name)
}
