//! The public interface of the store.

use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::task::JoinHandle;

use crate::digest::Digest;
use crate::error::{StoreError, is_damage};
use crate::index::Index;
use crate::pack::Folder;
use crate::readers::Readers;
use crate::writer::{Put, Shared, Writer};

/// A pack is closed and the next one begun at this size: large enough that packs stay few, small enough to copy one.
const PACK_BYTES: u64 = 2 << 30;

/// Bytes to store.
#[derive(Debug, Clone)]
pub struct Blob {
    /// SHA-256 of the bytes, lower-case hex; checked.
    pub digest: String,
    /// The bytes.
    pub bytes: Vec<u8>,
}

/// What a store holds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct StoreStats {
    /// Packs.
    pub packs: u64,
    /// Blobs that can be read.
    pub blobs: u64,
    /// Their bytes.
    pub bytes: u64,
    /// Packs that could not be read at all at start and were renamed to `….damaged`.
    pub set_aside: u64,
}

/// The condition of a stored blob.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scrubbed {
    /// Its bytes have the digest that names them.
    Good,
    /// They have another one, or cannot be read.
    Corrupt,
    /// It is not there.
    Missing,
}

/// Blobs by digest.
pub struct Store {
    pub(crate) shared: Arc<Shared>,
    writer: Mutex<Option<Writer>>,
    task: Mutex<Option<JoinHandle<()>>>,
    /// Held while packs are rewritten or copied, which must not overlap.
    pub(crate) upkeep: tokio::sync::Mutex<()>,
}

impl Store {
    /// Opens or creates the store in `folder/packs`. A pack that cannot be read at all is set aside: the others are good.
    ///
    /// # Errors
    /// [`StoreError::Pack`] naming a file that is some other database or a later format.
    pub async fn open(folder: &Path) -> Result<Self, StoreError> {
        Self::open_with(folder, PACK_BYTES).await
    }

    /// The same with packs of another size.
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

    /// Stores blobs; they are on the disk when this returns. What is there already is read and hashed: good bytes are not
    /// written again, so repeats are harmless, and damaged bytes are replaced.
    ///
    /// # Errors
    /// [`StoreError::DigestMismatch`], [`StoreError::NotADigest`]: nothing of the call is stored. [`StoreError::Full`].
    pub async fn put_all(&self, blobs: Vec<Blob>) -> Result<(), StoreError> {
        let checked = blocking(move || blobs.into_iter().map(checked).collect::<Result<Vec<_>, _>>());
        let mut new = Vec::new();
        for put in checked.await?? {
            let there = self.index().holds(&put.digest);
            if !there || self.scrubbed(put.digest).await? != Scrubbed::Good {
                new.push(put);
            }
        }
        if new.is_empty() {
            return Ok(());
        }
        self.writer()?.put(new).await
    }

    /// Reads and verifies a blob; `None` if it is not stored.
    ///
    /// # Errors
    /// [`StoreError::Corrupt`] when the stored bytes no longer have this digest: they are not served.
    pub async fn get(&self, digest: &str) -> Result<Option<Vec<u8>>, StoreError> {
        self.read(Digest::parse(digest)?).await
    }

    pub(crate) async fn read(&self, digest: Digest) -> Result<Option<Vec<u8>>, StoreError> {
        loop {
            let Some(place) = self.index().place(&digest) else {
                return Ok(None);
            };
            let read = self.shared.readers.read(place.pack, digest).await;
            let intact = match read {
                Ok(Some(bytes)) => {
                    let (found, bytes) = blocking(move || (Digest::hash(&bytes), bytes)).await?;
                    (found == digest).then_some(bytes)
                }
                Ok(None) => None,
                Err(error) if is_damage(&error) || !self.shared.folder.path(place.pack).exists() => None,
                // It was moved or deleted meanwhile.
                Err(_) if self.index().place(&digest) != Some(place) => continue,
                Err(error) => return Err(error.into()),
            };
            if intact.is_some() {
                return Ok(intact);
            }
            let mut index = self.index();
            if index.place(&digest) == Some(place) {
                index.set_damaged(digest, place);
                return Err(StoreError::Corrupt {
                    digest: digest.to_string(),
                });
            }
        }
    }

    /// Reads a blob and hashes it.
    ///
    /// # Errors
    /// [`StoreError::NotADigest`]; [`StoreError::Failed`] when the disk cannot be read.
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

    /// Deletes blobs, which leaves their space to [`Store::compact`]; returns their bytes. Missing blobs are skipped. None
    /// of them may be stored again before this returns.
    ///
    /// # Errors
    /// [`StoreError::NotADigest`]: nothing is deleted. [`StoreError::Full`]: some may be; the call can be repeated.
    pub async fn delete(&self, digests: &[String]) -> Result<u64, StoreError> {
        let digests = digests.iter().map(|digest| Digest::parse(digest));
        self.writer()?.delete(digests.collect::<Result<_, _>>()?).await
    }

    /// Whether a digest is stored and not known to be damaged.
    ///
    /// # Errors
    /// [`StoreError::NotADigest`].
    pub async fn contains(&self, digest: &str) -> Result<bool, StoreError> {
        let digest = Digest::parse(digest)?;
        Ok(self.index().holds(&digest))
    }

    /// What the store holds.
    #[must_use]
    pub fn stats(&self) -> StoreStats {
        let index = self.index();
        let uses = index.packs().values();
        let sum = |part: fn(&crate::index::PackUse) -> u64| uses.clone().map(part).sum();
        StoreStats {
            packs: index.packs().len() as u64,
            blobs: sum(|pack| pack.blobs),
            bytes: sum(|pack| pack.bytes),
            set_aside: index.set_aside(),
        }
    }

    /// Ends the writer after what it has taken on, and closes all connections.
    pub async fn close(&self) {
        // The writer's connection is the last: it folds the log into the pack.
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

/// Hashing takes too long for a thread that others wait for.
async fn blocking<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Result<T, StoreError> {
    let failed = |error: tokio::task::JoinError| StoreError::Failed {
        message: error.to_string(),
    };
    tokio::task::spawn_blocking(work).await.map_err(failed)
}

fn checked(blob: Blob) -> Result<Put, StoreError> {
    let digest = Digest::parse(&blob.digest)?;
    let found = Digest::hash(&blob.bytes);
    if found != digest {
        return Err(StoreError::DigestMismatch {
            claimed: blob.digest,
            found: found.to_string(),
        });
    }
    Ok(Put {
        digest,
        bytes: blob.bytes,
    })
}
