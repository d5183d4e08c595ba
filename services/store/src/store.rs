//! The public interface of the store.

use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::task::JoinHandle;

use crate::digest::Digest;
use crate::error::{StoreError, is_damage, is_unreadable};
use crate::index::Index;
use crate::pack::Folder;
use crate::readers::Readers;
use crate::writer::{CheckedBlob, Shared, Writer};

/// Size at which a pack is closed: large enough to keep packs few, small enough to copy one.
const PACK_BYTES: u64 = 2 << 30;

/// Bytes to store.
#[derive(Debug, Clone)]
pub struct Blob {
    /// SHA-256 of the bytes, lower-case hex; checked.
    pub digest: String,
    /// The content.
    pub bytes: Vec<u8>,
}

/// Contents of a store.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct StoreStats {
    /// Packs in use.
    pub packs: u64,
    /// Readable blobs.
    pub blobs: u64,
    /// Sum of their lengths, bytes.
    pub bytes: u64,
    /// Unreadable packs, renamed to `….damaged` at start.
    pub set_aside: u64,
}

/// Condition of a stored blob.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scrubbed {
    /// The bytes match the digest.
    Good,
    /// The bytes do not match, or cannot be read.
    Corrupt,
    /// Not stored.
    Missing,
}

/// Blobs by digest.
pub struct Store {
    pub(crate) shared: Arc<Shared>,
    writer: Mutex<Option<Writer>>,
    task: Mutex<Option<JoinHandle<()>>>,
    /// Serializes rewriting and copying of packs.
    pub(crate) upkeep: tokio::sync::Mutex<()>,
}

impl Store {
    /// Opens or creates the store in `folder/packs`. An unreadable pack is set aside, because the others are intact.
    ///
    /// # Errors
    /// [`StoreError::Pack`] for a foreign database or a later format.
    pub async fn open(folder: &Path) -> Result<Self, StoreError> {
        Self::open_with(folder, PACK_BYTES).await
    }

    /// Opens the store with another pack size, bytes.
    ///
    /// # Errors
    /// As [`Store::open`].
    pub async fn open_with(folder: &Path, pack_bytes: u64) -> Result<Self, StoreError> {
        let folder = Folder(folder.join("packs"));
        std::fs::create_dir_all(&folder.0)?;
        let packs = folder.packs()?;
        let shared = Arc::new(Shared {
            index: Mutex::new(Index::load(&folder, &packs).await?),
            readers: Readers::new(folder.clone()),
            folder,
            pack_bytes,
        });
        let (writer, task) = Writer::start(Arc::clone(&shared));
        Ok(Self {
            shared,
            writer: Mutex::new(Some(writer)),
            task: Mutex::new(Some(task)),
            upkeep: tokio::sync::Mutex::default(),
        })
    }

    /// Stores blobs durably. Blobs already stored are read and hashed: intact ones are not written again, so repeats
    /// are harmless, and damaged ones are replaced.
    ///
    /// # Errors
    /// [`StoreError::DigestMismatch`], [`StoreError::NotADigest`], [`StoreError::Full`]. The call then stored
    /// nothing.
    pub async fn put_all(&self, blobs: Vec<Blob>) -> Result<(), StoreError> {
        let checked = run_blocking(move || blobs.into_iter().map(verify).collect::<Result<Vec<_>, _>>());
        let mut new = Vec::new();
        for put in checked.await?? {
            let is_stored = self.index().holds(&put.digest);
            if !is_stored || self.scrubbed(put.digest).await? != Scrubbed::Good {
                new.push(put);
            }
        }
        if new.is_empty() {
            return Ok(());
        }
        self.writer()?.put(new).await
    }

    /// Finds out whether writes work.
    ///
    /// # Errors
    /// [`StoreError::Unwritable`], [`StoreError::Full`].
    pub async fn check_writes(&self) -> Result<(), StoreError> {
        self.writer()?.check().await
    }

    /// Reads and verifies a blob; `None` if it is not stored.
    ///
    /// # Errors
    /// [`StoreError::Corrupt`] if the stored bytes no longer match the digest.
    pub async fn get(&self, digest: &str) -> Result<Option<Vec<u8>>, StoreError> {
        self.read(Digest::parse(digest)?).await
    }

    pub(crate) async fn read(&self, digest: Digest) -> Result<Option<Vec<u8>>, StoreError> {
        loop {
            let Some(place) = self.index().locate(&digest) else {
                return Ok(None);
            };
            let read = self.shared.readers.read(place.pack, digest).await;
            let intact = match read {
                Ok(Some(bytes)) => {
                    let (found, bytes) = run_blocking(move || (Digest::hash(&bytes), bytes)).await?;
                    (found == digest).then_some(bytes)
                }
                Ok(None) => None,
                Err(error) if is_damage(&error) || is_unreadable(&error) => None,
                Err(_) if !self.shared.folder.path(place.pack).exists() => None,
                // Moved or deleted during the read.
                Err(_) if self.index().locate(&digest) != Some(place) => continue,
                Err(error) => return Err(error.into()),
            };
            if intact.is_some() {
                return Ok(intact);
            }
            let mut index = self.index();
            if index.locate(&digest) == Some(place) {
                index.set_damaged(digest, place);
                return Err(StoreError::Corrupt {
                    digest: digest.to_string(),
                });
            }
        }
    }

    /// Reads a blob and verifies its digest.
    ///
    /// # Errors
    /// [`StoreError::NotADigest`]; [`StoreError::Failed`] if the disk cannot be read.
    pub async fn scrub(&self, digest: &str) -> Result<Scrubbed, StoreError> {
        self.scrubbed(Digest::parse(digest)?).await
    }

    async fn scrubbed(&self, digest: Digest) -> Result<Scrubbed, StoreError> {
        match self.read(digest).await {
            Ok(Some(_)) => Ok(Scrubbed::Good),
            Ok(None) => Ok(Scrubbed::Missing),
            Err(StoreError::Corrupt { .. }) => Ok(Scrubbed::Corrupt),
            Err(error) => Err(error),
        }
    }

    /// Deletes blobs and returns their bytes; [`Store::compact`] reclaims the space. Missing blobs are skipped. Do
    /// not store any of them again before this returns.
    ///
    /// # Errors
    /// [`StoreError::NotADigest`]: nothing is deleted. [`StoreError::Full`]: some may be deleted; call again.
    pub async fn delete(&self, digests: &[String]) -> Result<u64, StoreError> {
        let digests = digests.iter().map(|digest| Digest::parse(digest));
        self.writer()?.delete(digests.collect::<Result<_, _>>()?).await
    }

    /// Whether a blob is stored and not known to be damaged.
    ///
    /// # Errors
    /// [`StoreError::NotADigest`].
    pub async fn contains(&self, digest: &str) -> Result<bool, StoreError> {
        let digest = Digest::parse(digest)?;
        Ok(self.index().holds(&digest))
    }

    /// Returns the current counts.
    #[must_use]
    pub fn stats(&self) -> StoreStats {
        let index = self.index();
        let uses = index.packs().values();
        StoreStats {
            packs: index.packs().len() as u64,
            blobs: uses.clone().map(|pack| pack.blobs).sum(),
            bytes: uses.map(|pack| pack.bytes).sum(),
            set_aside: index.set_aside(),
        }
    }

    /// Finishes the queued writes and closes all connections.
    pub async fn close(&self) {
        // The writer's connection must close last: it folds the log into the pack.
        self.shared.readers.close().await;
        drop(self.writer.lock().unwrap_or_else(PoisonError::into_inner).take());
        let task = self.task.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(task) = task {
            let _ = task.await;
        }
    }

    pub(crate) fn index(&self) -> MutexGuard<'_, Index> {
        self.shared.index()
    }

    pub(crate) fn writer(&self) -> Result<Writer, StoreError> {
        let writer = self.writer.lock().unwrap_or_else(PoisonError::into_inner);
        writer.clone().ok_or(StoreError::Closed)
    }
}

/// Runs `work`, usually hashing, outside the async threads.
async fn run_blocking<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Result<T, StoreError> {
    tokio::task::spawn_blocking(work)
        .await
        .map_err(|error| StoreError::Failed {
            message: error.to_string(),
        })
}

fn verify(blob: Blob) -> Result<CheckedBlob, StoreError> {
    let digest = Digest::parse(&blob.digest)?;
    let found = Digest::hash(&blob.bytes);
    if found != digest {
        return Err(StoreError::DigestMismatch {
            claimed: blob.digest,
            found: found.to_string(),
        });
    }
    Ok(CheckedBlob {
        digest,
        bytes: blob.bytes,
    })
}
