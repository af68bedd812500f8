//! Files that are there whole or not at all.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Writes a file beside its place, flushes it to the disk and renames it: a reader sees the old one or the new
/// one, also after a power cut. Leaves nothing behind where it fails.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let (mut file, beside) = create_beside(path)?;
    let written = file.write_all(bytes).and_then(|()| file.sync_all());
    drop(file); // some systems rename closed files only
    let renamed = written.and_then(|()| fs::rename(&beside, path));
    if renamed.is_err() {
        // What went wrong first is the error to tell.
        let _ = fs::remove_file(&beside);
    }
    renamed
}

/// A new file next to `path`, of a name that no other writer has and no crash left there.
fn create_beside(path: &Path) -> io::Result<(File, PathBuf)> {
    let mut n = 0_u64;
    loop {
        let mut beside = path.as_os_str().to_owned();
        beside.push(format!(".{n}.partial"));
        match File::create_new(&beside) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => n += 1,
            created => return Ok((created?, beside.into())),
        }
    }
}
