//! The done-file of a folder: what the folder held when it was finished, so that damage shows.
//!
//! It lists the SHA-256 of every file beside it but `timing.json`, as `sha256sum` does: `sha256sum --check done` in the
//! folder finds what is damaged, too.

use std::fmt::Write;
use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::atomic::write_atomically;
use super::error::{StoreError, at};

/// The name of the done-file.
const FILE: &str = "done";
/// The file for which no done-file vouches: it differs between equal runs.
pub(super) const TIMING: &str = "timing.json";

/// How far the folder of a run or an evaluation has come.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum State {
    /// It is not there, or was not finished.
    Unfinished,
    /// It was finished, but is no longer what it was then.
    Damaged {
        /// The folder.
        folder: PathBuf,
        /// What is wrong with it, as in "policy.safetensors is not what was written".
        what: String,
    },
    /// It is all there, as it was written.
    Complete,
}

/// Whether the folder was ever finished, whatever has become of it.
pub(super) fn is_marked(folder: &Path) -> bool {
    folder.join(FILE).is_file()
}

/// Flushes the files of a folder to the disk, then marks the folder as complete.
pub(super) fn mark_complete(folder: &Path) -> Result<(), StoreError> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).map_err(at("read", folder))? {
        let path = entry.map_err(at("read", folder))?.path();
        if path.is_file() {
            let file = File::options().append(true).open(&path);
            file.and_then(|file| file.sync_all()).map_err(at("write", &path))?;
            names.extend(path.file_name().and_then(|name| name.to_str()).map(str::to_owned));
        }
    }
    names.retain(|name| name != TIMING);
    names.sort();
    let mut text = String::new();
    for name in names {
        let path = folder.join(&name);
        let bytes = fs::read(&path).map_err(at("read", &path))?;
        text.push_str(&format!("{}  {name}\n", digest(&bytes)));
    }
    write_atomically(&folder.join(FILE), text.as_bytes())
}

/// Compares a folder with its done-file.
///
/// # Errors
/// [`StoreError::Io`] if a file is there and cannot be read.
pub(super) fn state(folder: &Path) -> Result<State, StoreError> {
    let Some(done) = read_if_there(&folder.join(FILE))? else { return Ok(State::Unfinished) };
    let damaged = |what| Ok(State::Damaged { folder: folder.to_owned(), what });
    let done = String::from_utf8_lossy(&done);
    if done.lines().next().is_none() {
        return damaged(format!("its file `{FILE}` is empty"));
    }
    for line in done.lines() {
        let Some((expected, name)) = line.split_once("  ") else {
            return damaged(format!("its file `{FILE}` is not what was written"));
        };
        match read_if_there(&folder.join(name))? {
            None => return damaged(format!("{name} is missing")),
            Some(bytes) if digest(&bytes) != expected => return damaged(format!("{name} is not what was written")),
            Some(_) => {}
        }
    }
    Ok(State::Complete)
}

/// The bytes of a file, if it exists.
pub(super) fn read_if_there(path: &Path) -> Result<Option<Vec<u8>>, StoreError> {
    match fs::read(path) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(at("read", path)(error)),
    }
}

/// The SHA-256 hash in hexadecimal digits.
pub(crate) fn digest(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().fold(String::new(), |mut digits, byte| {
        // Writing to a string cannot fail.
        let _ = write!(digits, "{byte:02x}");
        digits
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_that_of_sha256sum() {
        assert_eq!(digest(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }

    #[test]
    fn a_folder_is_what_its_done_file_says() {
        let temporary = tempfile::tempdir().unwrap();
        let folder = temporary.path();
        let damaged = |what: &str| State::Damaged { folder: folder.to_owned(), what: what.to_owned() };
        fs::write(folder.join("a"), "abc").unwrap();
        fs::write(folder.join(TIMING), "now").unwrap();
        assert_eq!(state(folder).unwrap(), State::Unfinished);
        mark_complete(folder).unwrap();
        fs::write(folder.join(TIMING), "later").unwrap();
        assert_eq!(state(folder).unwrap(), State::Complete);
        fs::write(folder.join("a"), "abd").unwrap();
        assert_eq!(state(folder).unwrap(), damaged("a is not what was written"));
        fs::remove_file(folder.join("a")).unwrap();
        assert_eq!(state(folder).unwrap(), damaged("a is missing"));
        fs::write(folder.join(FILE), "").unwrap(); // as written by versions that did not vouch for anything
        assert_eq!(state(folder).unwrap(), damaged("its file `done` is empty"));
    }
}
