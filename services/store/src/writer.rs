//! The one task that writes. What callers bring while it is busy shares the next transaction and its flush to the disk.

use std::sync::{Arc, Mutex, PoisonError};

use sqlx::{Connection, SqliteConnection};
use tokio::sync::{mpsc, oneshot};
use tokio::task::JoinHandle;

use crate::digest::Digest;
use crate::error::StoreError;
use crate::index::{Index, Place};
use crate::pack::Folder;

/// Calls that may wait; beyond it callers wait to be taken on, which slows them down before memory grows.
const QUEUE: usize = 64;
/// Bytes of one transaction: a larger one would only delay its first caller.
const GROUP_BYTES: usize = 64 << 20;

/// A blob whose digest was checked.
pub(crate) struct Put {
    pub(crate) digest: Digest,
    pub(crate) bytes: Vec<u8>,
}

type Call = (Vec<Put>, oneshot::Sender<Result<(), StoreError>>);

/// The way to the writer.
#[derive(Clone)]
pub(crate) struct Writer(mpsc::Sender<Call>);

impl Writer {
    pub(crate) fn start(folder: Folder, index: Arc<Mutex<Index>>, pack_bytes: u64) -> (Self, JoinHandle<()>) {
        let (sender, receiver) = mpsc::channel(QUEUE);
        let task = Task {
            folder,
            index,
            pack_bytes,
            open: None,
        };
        (Self(sender), tokio::spawn(task.run(receiver)))
    }

    pub(crate) async fn put(&self, blobs: Vec<Put>) -> Result<(), StoreError> {
        let (sender, receiver) = oneshot::channel();
        self.0
            .send((blobs, sender))
            .await
            .map_err(|_| StoreError::Closed)?;
        receiver.await.map_err(|_| StoreError::Closed)?
    }
}

struct Task {
    folder: Folder,
    index: Arc<Mutex<Index>>,
    pack_bytes: u64,
    /// The pack that grows.
    open: Option<(u32, SqliteConnection)>,
}

impl Task {
    async fn run(mut self, mut queue: mpsc::Receiver<Call>) {
        while let Some(first) = queue.recv().await {
            let mut calls = vec![first];
            let bytes = |calls: &[Call]| {
                calls
                    .iter()
                    .flat_map(|(puts, _)| puts)
                    .map(|put| put.bytes.len())
                    .sum::<usize>()
            };
            while bytes(&calls) < GROUP_BYTES {
                let Ok(call) = queue.try_recv() else { break };
                calls.push(call);
            }
            let (blobs, answers): (Vec<_>, Vec<_>) = calls.into_iter().unzip();
            let result = self.store(blobs.into_iter().flatten().collect()).await;
            if result.is_err() {
                // A connection that failed may be in the middle of something: begin afresh.
                self.open = None;
            }
            for answer in answers {
                let told = result.as_ref().copied().map_err(StoreError::again);
                // A caller that went away loses nothing: the bytes are stored under their digest.
                let _ = answer.send(told);
            }
        }
        if let Some((_, connection)) = self.open.take()
            && let Err(error) = connection.close().await
        {
            tracing::warn!(%error, "the artifact pack did not close cleanly");
        }
    }

    async fn store(&mut self, mut blobs: Vec<Put>) -> Result<(), StoreError> {
        {
            let index = self.index.lock().unwrap_or_else(PoisonError::into_inner);
            blobs.retain(|blob| !index.holds(&blob.digest));
        }
        blobs.sort_unstable_by_key(|blob| blob.digest);
        blobs.dedup_by_key(|blob| blob.digest);
        if blobs.is_empty() {
            return Ok(());
        }
        let (pack, connection) = self.pack().await?;
        let mut transaction = connection.begin_with("BEGIN IMMEDIATE").await?;
        for blob in &blobs {
            // Damaged bytes of this digest are replaced.
            sqlx::query("DELETE FROM entry WHERE digest = ?")
                .bind(&blob.digest.0[..])
                .execute(&mut *transaction)
                .await?;
            let data = sqlx::query("INSERT INTO data (bytes) VALUES (?)")
                .bind(&blob.bytes)
                .execute(&mut *transaction)
                .await?
                .last_insert_rowid();
            sqlx::query("INSERT INTO entry (digest, length, data) VALUES (?, ?, ?)")
                .bind(&blob.digest.0[..])
                .bind(blob.bytes.len() as i64)
                .bind(data)
                .execute(&mut *transaction)
                .await?;
        }
        faults::point("pack.written");
        transaction.commit().await?;
        faults::point("pack.committed");
        let mut index = self.index.lock().unwrap_or_else(PoisonError::into_inner);
        for blob in &blobs {
            index.insert(
                blob.digest,
                Place {
                    pack,
                    length: blob.bytes.len() as u64,
                },
            );
        }
        Ok(())
    }

    /// The pack that grows; a new one when the last is full.
    async fn pack(&mut self) -> Result<(u32, &mut SqliteConnection), StoreError> {
        let last = self.index.lock().unwrap_or_else(PoisonError::into_inner).last();
        let number = match last {
            Some((pack, used)) if used.bytes < self.pack_bytes => pack,
            other => {
                let next = other.map_or(1, |(pack, _)| pack + 1);
                self.folder.create(next).await?;
                self.index
                    .lock()
                    .unwrap_or_else(PoisonError::into_inner)
                    .add_pack(next);
                next
            }
        };
        if self.open.as_ref().is_none_or(|(open, _)| *open != number) {
            if let Some((_, full)) = self.open.take() {
                full.close().await?;
            }
            self.open = Some((number, self.folder.writer(number).await?));
        }
        let (_, connection) = self.open.as_mut().ok_or(StoreError::Closed)?;
        Ok((number, connection))
    }
}
