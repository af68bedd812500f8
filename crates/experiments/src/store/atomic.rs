//! Files that are there whole or not at all.

use std::fs::{self, File};
use std::io::Write;
use std::path::Path;

use super::error::{StoreError, at};

/// Writes a file beside its place, flushes it to the disk and renames it: a reader sees the old one or the new one.
pub(super) fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), StoreError> {
    let mut beside = path.as_os_str().to_owned();
    beside.push(".partial");
    let beside = Path::new(&beside);
    let written = File::create(beside).and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_all()));
    written.and_then(|()| fs::rename(beside, path)).map_err(at("write", path))
}

/// An empty folder at `path`, whatever was there.
pub(super) fn fresh_folder(path: &Path) -> Result<(), StoreError> {
    if path.exists() {
        fs::remove_dir_all(path).map_err(at("remove the half-written", path))?;
    }
    fs::create_dir_all(path).map_err(at("create", path))
}
