//! The folder of a service, opened by one process.

mod lock;

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use catalogue::{Catalogue, CatalogueError};
use store::{Store, StoreError};

pub use lock::LockError;

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
    /// Another process has it.
    #[error(transparent)]
    Lock(#[from] LockError),
    /// The catalogue cannot be opened.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
    /// The artifact store cannot be opened.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// What a data folder holds. While this value lives, no other process gets it.
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
        let lock = lock::take(folder)?;
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
