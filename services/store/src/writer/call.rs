//! Requests to the writer.

use std::sync::{Mutex, MutexGuard, PoisonError};

use tokio::sync::oneshot;

use crate::digest::Digest;
use crate::error::StoreError;
use crate::index::Index;
use crate::pack::Folder;
use crate::readers::Readers;

/// Maximum bytes of a transaction: a larger one would only delay its first caller.
pub(super) const GROUP_BYTES: usize = 64 << 20;

/// A blob with a verified digest.
pub(crate) struct CheckedBlob {
    pub(crate) digest: Digest,
    pub(crate) bytes: Vec<u8>,
}

pub(super) type Reply<T> = oneshot::Sender<Result<T, StoreError>>;

pub(super) enum Call {
    Put(Vec<CheckedBlob>, Reply<()>),
    /// Blobs of a pack under compaction, to be stored in the open pack.
    Move(u32, Vec<CheckedBlob>, Reply<()>),
    Delete(Vec<Digest>, Reply<u64>),
    /// Writes and syncs a page without a change of content.
    Check(Reply<()>),
    /// Removes a pack without blobs.
    Remove(u32, Reply<bool>),
}

/// State shared by the writer and the store.
pub(crate) struct Shared {
    pub(crate) folder: Folder,
    pub(crate) index: Mutex<Index>,
    pub(crate) readers: Readers,
    pub(crate) pack_bytes: u64,
}

impl Shared {
    pub(crate) fn index(&self) -> MutexGuard<'_, Index> {
        self.index.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
