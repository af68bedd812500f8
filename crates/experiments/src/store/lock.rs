//! One writer per results folder.

use std::fs::{File, TryLockError};
use std::path::Path;

use super::error::{StoreError, at};

/// Takes the folder's lock, which lasts as long as the file stays open.
pub(super) fn hold(folder: &Path) -> Result<File, StoreError> {
    let path = folder.join(".lock");
    let file = File::options().create(true).truncate(false).write(true).open(path);
    let file = file.map_err(at("write to the results folder", folder))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(StoreError::InUse { folder: folder.to_owned() }),
        Err(TryLockError::Error(source)) => Err(at("lock the results folder", folder)(source)),
    }
}
