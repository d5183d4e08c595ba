//! The data folder of a service, opened by one process.

use std::fs::{File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use catalogue::{Catalogue, CatalogueError};
use store::{Store, StoreError};

use crate::operations::routes::backup::newest;

/// Why a data folder cannot be opened.
#[derive(Debug, thiserror::Error)]
pub enum DataError {
    /// The folder cannot be created.
    #[error("cannot use the data directory {}: {source}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Error of the file system.
        source: io::Error,
    },
    /// Another service uses the folder.
    #[error("another service already uses {}", .0.display())]
    Taken(PathBuf),
    /// The lock file cannot be used.
    #[error("cannot lock {}: {source}", path.display())]
    Lock {
        /// The lock file.
        path: PathBuf,
        /// Error of the file system.
        source: io::Error,
    },
    /// Packs without a catalogue.
    #[error(
        "{} has packs of artifacts, but catalogue.sqlite is missing or empty. Put it back, or move the whole folder away and \
         restore a backup; `fathom scrub --rebuild` takes the catalogue of the newest backup in it, and what came later is \
         rendered again", .0.display()
    )]
    NoCatalogue(PathBuf),
    /// A catalogue without its packs.
    #[error(
        "the catalogue in {} names artifacts, but its folder packs is missing or empty. Put it back, or restore a backup; \
         `fathom scrub --rebuild` renders everything again", .0.display()
    )]
    NoPacks(PathBuf),
    /// The packs belong to another catalogue.
    #[error(
        "the packs in {} belong to another catalogue than the one beside them: put the right one back, or move it away and run \
         `fathom scrub --rebuild`", .0.display()
    )]
    OtherPacks(PathBuf),
    /// The catalogue cannot be rebuilt.
    #[error("{} cannot get its catalogue from a backup: {reason}", path.display())]
    NotRebuilt {
        /// The folder.
        path: PathBuf,
        /// Cause.
        reason: String,
    },
    /// The catalogue cannot be opened.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
    /// The artifact store cannot be opened.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// An open data folder, locked while this value exists.
pub struct Data {
    /// Jobs, images, scenes.
    pub catalogue: Catalogue,
    /// The artifacts.
    pub store: Store,
    pub(crate) lock: FolderLock,
}

impl Data {
    /// Opens or creates the folder. `metrics` are the minimum columns of the catalogue.
    ///
    /// # Errors
    /// [`DataError`].
    pub async fn open(folder: &Path, metrics: &[String]) -> Result<Self, DataError> {
        let path = folder.to_owned();
        tokio::fs::create_dir_all(folder)
            .await
            .map_err(|source| DataError::Folder { path, source })?;
        Self::open_as(folder, metrics, has_packs(folder)).await
    }

    /// Opens the folder even if its packs are missing.
    ///
    /// # Errors
    /// [`DataError`].
    pub async fn open_without_packs(folder: &Path, metrics: &[String]) -> Result<Self, DataError> {
        Self::open_as(folder, metrics, true).await
    }

    async fn open_as(folder: &Path, metrics: &[String], packs: bool) -> Result<Self, DataError> {
        let lock = lock(folder)?;
        let path = folder.join(CATALOGUE);
        if is_missing(&path) && has_packs(folder) {
            return Err(DataError::NoCatalogue(folder.to_owned()));
        }
        let data = Self {
            catalogue: Catalogue::open(&path, metrics).await?,
            store: Store::open(folder).await?,
            lock,
        };
        // SQLite syncs the content of a new catalogue, but not its directory entry.
        if let Err(error) = File::open(folder).and_then(|folder| folder.sync_all()) {
            tracing::warn!(%error, "cannot sync the data folder");
        }
        match data.belong_together(folder, packs).await {
            Ok(()) => Ok(data),
            Err(error) => {
                data.close().await;
                Err(error)
            }
        }
    }

    async fn belong_together(&self, folder: &Path, packs: bool) -> Result<(), DataError> {
        if !packs && self.catalogue.names_bytes().await? {
            return Err(DataError::NoPacks(folder.to_owned()));
        }
        let id = match self.catalogue.folder().await {
            Err(error @ CatalogueError::Damaged { .. }) => {
                tracing::error!(%error, "cannot check whether the packs belong to this catalogue");
                self.catalogue.note_damage(&error.to_string());
                return Ok(());
            }
            other => other?,
        };
        match self.store.folder()? {
            Some(known) if known != id => Err(DataError::OtherPacks(folder.to_owned())),
            Some(_) => Ok(()),
            None => {
                // Storing it can wait for the next start if the disk is full.
                if let Err(error) = self.store.set_folder(&id) {
                    tracing::warn!(%error, "cannot store the id of the catalogue with the packs");
                }
                Ok(())
            }
        }
    }

    /// Restores the catalogue from the newest backup if the packs have none, and returns the backup's folder; `None`
    /// if the catalogue exists.
    ///
    /// # Errors
    /// [`DataError::NotRebuilt`] without a backup; [`DataError::Taken`].
    pub fn rebuild(folder: &Path) -> Result<Option<PathBuf>, DataError> {
        let path = folder.join(CATALOGUE);
        if !is_missing(&path) {
            return Ok(None);
        }
        let _lock = lock(folder)?;
        restore_newest(folder, &path)
            .map(Some)
            .map_err(|error| DataError::NotRebuilt {
                path: folder.to_owned(),
                reason: error.to_string(),
            })
    }

    /// Closes the databases in order, then unlocks the folder.
    pub async fn close(self) {
        self.catalogue.close().await;
        self.store.close().await;
    }
}

/// Copies the catalogue of the newest backup to `path`; returns the backup's folder.
fn restore_newest(folder: &Path, path: &Path) -> io::Result<PathBuf> {
    let backup = newest(folder)?.ok_or_else(|| {
        io::Error::other("its folder `backups` is empty; put a backup of `fathom backup` there")
    })?;
    let unfinished = path.with_extension("unfinished");
    std::fs::copy(backup.join(CATALOGUE), &unfinished)?;
    File::open(&unfinished)?.sync_all()?;
    // SQLite would apply the log of the old catalogue to this one.
    for end in ["sqlite-wal", "sqlite-shm"] {
        match std::fs::remove_file(path.with_extension(end)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
    }
    std::fs::rename(&unfinished, path)?;
    File::open(folder)?.sync_all()?;
    Ok(backup)
}

const CATALOGUE: &str = "catalogue.sqlite";

fn is_missing(catalogue: &Path) -> bool {
    std::fs::metadata(catalogue).map_or(true, |file| file.len() == 0)
}

/// Whether the folder has packs that require a catalogue, including damaged packs that were set aside.
fn has_packs(folder: &Path) -> bool {
    let entries = std::fs::read_dir(folder.join("packs"))
        .into_iter()
        .flatten()
        .flatten();
    entries
        .map(|entry| entry.file_name())
        .any(|name| name != "folder.id")
}

/// The lock of a data folder: on a file in it, and on the folder itself.
#[derive(Debug)]
pub(crate) struct FolderLock {
    _file: File,
    _folder: Option<File>,
}

/// Locks the data folder until this is dropped, also if the process is killed.
fn lock(folder: &Path) -> Result<FolderLock, DataError> {
    let path = folder.join("lock");
    // A file can be deleted under its lock, the folder cannot. Some network file systems lock no folders.
    let itself = File::open(folder).ok();
    if let Some(Err(TryLockError::WouldBlock)) = itself.as_ref().map(File::try_lock) {
        return Err(DataError::Taken(folder.to_owned()));
    }
    let opened = File::options()
        .create(true)
        .truncate(false)
        .write(true)
        .open(&path);
    let locked = opened.map_err(TryLockError::Error).and_then(|file| {
        file.try_lock()?;
        Ok(FolderLock {
            _file: file,
            _folder: itself,
        })
    });
    locked.map_err(|error| match error {
        TryLockError::WouldBlock => DataError::Taken(folder.to_owned()),
        TryLockError::Error(source) => DataError::Lock { path, source },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_directory_is_taken_once_and_free_again_afterwards() {
        let dir = tempfile::tempdir().unwrap();
        let held = lock(dir.path()).unwrap();
        assert!(matches!(lock(dir.path()), Err(DataError::Taken(_))));
        std::fs::remove_file(dir.path().join("lock")).unwrap();
        assert!(matches!(lock(dir.path()), Err(DataError::Taken(_))));
        drop(held);
        assert!(lock(dir.path()).is_ok());
    }
}
