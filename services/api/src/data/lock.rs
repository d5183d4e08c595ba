//! One service for each data directory.

use std::fs::{File, TryLockError};
use std::path::Path;

/// Why the data directory could not be taken.
#[derive(Debug, thiserror::Error)]
pub enum LockError {
    /// Another service runs on it.
    #[error("another service already uses {0}")]
    Taken(String),
    /// The file system refused.
    #[error("cannot lock {path}: {source}")]
    Io {
        /// The lock file.
        path: String,
        /// What the file system said.
        source: std::io::Error,
    },
}

/// Takes the data directory. The lock ends when the file is dropped, also when the process is killed.
pub(crate) fn take(data: &Path) -> Result<File, LockError> {
    let path = data.join("lock");
    let io = |source| LockError::Io {
        path: path.display().to_string(),
        source,
    };
    let file = File::options()
        .create(true)
        .truncate(false)
        .write(true)
        .open(&path)
        .map_err(io)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(LockError::Taken(data.display().to_string())),
        Err(TryLockError::Error(source)) => Err(io(source)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_directory_is_taken_once_and_free_again_afterwards() {
        let dir = tempfile::tempdir().unwrap();
        let held = take(dir.path()).unwrap();
        assert!(matches!(take(dir.path()), Err(LockError::Taken(_))));
        drop(held);
        assert!(take(dir.path()).is_ok());
    }
}
