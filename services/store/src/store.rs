//! The store as its users see it.

use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::task::JoinHandle;

use crate::digest::Digest;
use crate::error::StoreError;
use crate::index::Index;
use crate::pack::Folder;
use crate::readers::Readers;
use crate::writer::{Put, Writer};

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
}

/// Blobs by digest.
pub struct Store {
    index: Arc<Mutex<Index>>,
    readers: Readers,
    writer: Mutex<Option<Writer>>,
    task: Mutex<Option<JoinHandle<()>>>,
}

impl Store {
    /// Opens or creates the store in `folder/packs`.
    ///
    /// # Errors
    /// [`StoreError::Pack`] naming a file that is no readable pack.
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
        let index = Arc::new(Mutex::new(Index::load(&folder, &packs).await?));
        let (writer, task) = Writer::start(folder.clone(), Arc::clone(&index), pack_bytes);
        Ok(Self {
            index,
            readers: Readers::new(folder),
            writer: Mutex::new(Some(writer)),
            task: Mutex::new(Some(task)),
        })
    }

    /// Stores blobs; they are on the disk when this returns. What is there already is not written again, so repeats are
    /// harmless.
    ///
    /// # Errors
    /// [`StoreError::DigestMismatch`], [`StoreError::NotADigest`]: nothing of the call is stored. [`StoreError::Full`].
    pub async fn put_all(&self, blobs: Vec<Blob>) -> Result<(), StoreError> {
        let checked = tokio::task::spawn_blocking(move || {
            blobs.into_iter().map(checked).collect::<Result<Vec<_>, _>>()
        });
        let mut new = checked.await.map_err(|error| StoreError::Failed {
            message: error.to_string(),
        })??;
        {
            let index = self.index();
            new.retain(|put| !index.holds(&put.digest));
        }
        if new.is_empty() {
            return Ok(());
        }
        let writer = self
            .writer
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
            .ok_or(StoreError::Closed)?;
        writer.put(new).await
    }

    /// The bytes of a digest, hashed again; none if it was never stored.
    ///
    /// # Errors
    /// [`StoreError::Corrupt`] when the stored bytes no longer have this digest: they are not served.
    pub async fn get(&self, digest: &str) -> Result<Option<Vec<u8>>, StoreError> {
        let digest = Digest::parse(digest)?;
        let Some(place) = self.index().place(&digest) else {
            return Ok(None);
        };
        let corrupt = || {
            self.index().set_damaged(digest);
            StoreError::Corrupt {
                digest: digest.to_string(),
            }
        };
        let bytes = match self.readers.read(place.pack, digest).await {
            Ok(Some(bytes)) => bytes,
            Ok(None) => return Err(corrupt()),
            Err(error) if crate::error::is_damage(&error) => return Err(corrupt()),
            Err(error) => return Err(error.into()),
        };
        let hashed = tokio::task::spawn_blocking(move || (Digest::of(&bytes), bytes)).await;
        let (found, bytes) = hashed.map_err(|error| StoreError::Failed {
            message: error.to_string(),
        })?;
        if found == digest {
            Ok(Some(bytes))
        } else {
            Err(corrupt())
        }
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
        }
    }

    /// Ends the writer after what it has taken on.
    pub async fn close(&self) {
        drop(self.writer.lock().unwrap_or_else(PoisonError::into_inner).take());
        let task = self.task.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(task) = task {
            let _ = task.await;
        }
    }

    fn index(&self) -> MutexGuard<'_, Index> {
        self.index.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn checked(blob: Blob) -> Result<Put, StoreError> {
    let digest = Digest::parse(&blob.digest)?;
    let found = Digest::of(&blob.bytes);
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
