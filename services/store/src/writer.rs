//! The only task that writes. Calls that arrive while it is busy share the next transaction and its flush to disk.

mod call;
mod task;

use std::sync::Arc;

use tokio::sync::{mpsc, oneshot};
use tokio::task::JoinHandle;

use crate::digest::Digest;
use crate::error::StoreError;

use self::task::Task;
use call::{Call, Reply};
pub(crate) use call::{CheckedBlob, Shared};

/// Maximum queued calls. Further callers wait, which bounds memory.
const QUEUE: usize = 64;
#[derive(Clone)]
pub(crate) struct Writer(mpsc::Sender<Call>);

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

    pub(crate) async fn check(&self) -> Result<(), StoreError> {
        self.call(Call::Check).await
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
