//! The folder of a service, opened by one process.

use std::fs::{File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use catalogue::{Catalogue, CatalogueError};
use store::{Store, StoreError};

/// Why a data folder cannot be opened.
#[derive(Debug, thiserror::Error)]
pub enum DataError {
    /// The folder cannot be made.
    #[error("cannot use the data directory {}: {source}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the file system said.
        source: io::Error,
    },
    /// Another service runs on it.
    #[error("another service already uses {}", .0.display())]
    Taken(PathBuf),
    /// The lock file cannot be used.
    #[error("cannot lock {}: {source}", path.display())]
    Lock {
        /// The lock file.
        path: PathBuf,
        /// What the file system said.
        source: io::Error,
    },
    /// The catalogue cannot be opened.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
    /// The artifact store cannot be opened.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// An open data folder, locked while this value lives.
pub struct Data {
    /// Jobs, images, scenes.
    pub catalogue: Catalogue,
    /// The bytes.
    pub store: Store,
    pub(crate) lock: File,
}

impl Data {
    /// Opens or creates the folder. `metrics`: the columns that the catalogue has at least.
    ///
    /// # Errors
    /// [`DataError`].
    pub async fn open(folder: &Path, metrics: &[String]) -> Result<Self, DataError> {
        let path = folder.to_owned();
        tokio::fs::create_dir_all(folder)
            .await
            .map_err(|source| DataError::Folder { path, source })?;
        let lock = lock(folder)?;
        Ok(Self {
            catalogue: Catalogue::open(&folder.join("catalogue.sqlite"), metrics).await?,
            store: Store::open(folder).await?,
            lock,
        })
    }

    /// Closes the databases in order; the folder is free afterwards.
    pub async fn close(self) {
        self.catalogue.close().await;
        self.store.close().await;
    }
}

/// Takes the data directory. The lock ends when the file is dropped, also when the process is killed.
fn lock(folder: &Path) -> Result<File, DataError> {
    let path = folder.join("lock");
    let refused = |source| DataError::Lock {
        path: path.clone(),
        source,
    };
    let file = File::options()
        .create(true)
        .truncate(false)
        .write(true)
        .open(&path)
        .map_err(refused)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(DataError::Taken(folder.to_owned())),
        Err(TryLockError::Error(source)) => Err(refused(source)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_directory_is_taken_once_and_free_again_afterwards() {
        let dir = tempfile::tempdir().unwrap();
        let held = lock(dir.path()).unwrap();
        assert!(matches!(lock(dir.path()), Err(DataError::Taken(_))));
        drop(held);
        assert!(lock(dir.path()).is_ok());
    }
}
