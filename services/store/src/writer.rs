//! The only task that writes. Calls that arrive while it is busy share the next transaction and its flush to disk.

mod task;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::{mpsc, oneshot};
use tokio::task::JoinHandle;

use crate::digest::Digest;
use crate::error::StoreError;
use crate::index::Index;
use crate::pack::Folder;
use crate::readers::Readers;

use self::task::Task;

/// Maximum queued calls. Further callers wait, which bounds memory.
const QUEUE: usize = 64;
/// Maximum bytes of a transaction: a larger one would only delay its first caller.
const GROUP_BYTES: usize = 64 << 20;

/// A blob with a verified digest.
pub(crate) struct CheckedBlob {
    pub(crate) digest: Digest,
    pub(crate) bytes: Vec<u8>,
}

type Reply<T> = oneshot::Sender<Result<T, StoreError>>;

enum Call {
    Put(Vec<CheckedBlob>, Reply<()>),
    /// Blobs of a pack under compaction, to be stored in the open pack.
    Move(u32, Vec<CheckedBlob>, Reply<()>),
    Delete(Vec<Digest>, Reply<u64>),
    /// Removes a pack without blobs.
    Remove(u32, Reply<bool>),
}

#[derive(Clone)]
pub(crate) struct Writer(mpsc::Sender<Call>);

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

impl Writer {
    pub(crate) fn start(shared: Arc<Shared>) -> (Self, JoinHandle<()>) {
        let (sender, receiver) = mpsc::channel(QUEUE);
        let task = Task { shared, open: None };
        (Self(sender), tokio::spawn(task.run(receiver)))
    }

    pub(crate) async fn put(&self, blobs: Vec<CheckedBlob>) -> Result<(), StoreError> {
        self.call(|reply| Call::Put(blobs, reply)).await
    }

    pub(crate) async fn move_blobs(&self, from: u32, blobs: Vec<CheckedBlob>) -> Result<(), StoreError> {
        self.call(|reply| Call::Move(from, blobs, reply)).await
    }

    pub(crate) async fn delete(&self, digests: Vec<Digest>) -> Result<u64, StoreError> {
        self.call(|reply| Call::Delete(digests, reply)).await
    }

    pub(crate) async fn remove(&self, pack: u32) -> Result<bool, StoreError> {
        self.call(|reply| Call::Remove(pack, reply)).await
    }

    async fn call<T>(&self, call: impl FnOnce(Reply<T>) -> Call) -> Result<T, StoreError> {
        let (sender, receiver) = oneshot::channel();
        self.0.send(call(sender)).await.map_err(|_| StoreError::Closed)?;
        receiver.await.map_err(|_| StoreError::Closed)?
    }
}
