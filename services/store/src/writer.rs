//! The one task that writes. Calls that arrive while it is busy share the next transaction and its flush to the disk.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use sqlx::{Connection, SqliteConnection};
use tokio::sync::{mpsc, oneshot};
use tokio::task::JoinHandle;

use crate::digest::Digest;
use crate::error::StoreError;
use crate::index::{Index, Place};
use crate::pack::{Folder, fold_in, forget, transaction};
use crate::readers::Readers;

/// Calls that may be queued; further callers wait to be queued, which slows them down before memory grows.
const QUEUE: usize = 64;
/// Bytes of one transaction: a larger one would only delay its first caller.
const GROUP_BYTES: usize = 64 << 20;

/// A blob whose digest was checked.
pub(crate) struct Put {
    pub(crate) digest: Digest,
    pub(crate) bytes: Vec<u8>,
}

type Answer<T> = oneshot::Sender<Result<T, StoreError>>;

enum Call {
    Put(Vec<Put>, Answer<()>),
    /// Blobs of a pack that is rewritten, to be stored in the one that grows.
    Move(u32, Vec<Put>, Answer<()>),
    Delete(Vec<Digest>, Answer<u64>),
    /// Takes a pack away that holds no blob any more.
    Remove(u32, Answer<bool>),
}

/// A handle to the writer.
#[derive(Clone)]
pub(crate) struct Writer(mpsc::Sender<Call>);

/// What the writer shares with the store.
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

    pub(crate) async fn put(&self, blobs: Vec<Put>) -> Result<(), StoreError> {
        self.call(|answer| Call::Put(blobs, answer)).await
    }

    pub(crate) async fn shift(&self, from: u32, blobs: Vec<Put>) -> Result<(), StoreError> {
        self.call(|answer| Call::Move(from, blobs, answer)).await
    }

    pub(crate) async fn delete(&self, digests: Vec<Digest>) -> Result<u64, StoreError> {
        self.call(|answer| Call::Delete(digests, answer)).await
    }

    pub(crate) async fn remove(&self, pack: u32) -> Result<bool, StoreError> {
        self.call(|answer| Call::Remove(pack, answer)).await
    }

    async fn call<T>(&self, call: impl FnOnce(Answer<T>) -> Call) -> Result<T, StoreError> {
        let (sender, receiver) = oneshot::channel();
        self.0.send(call(sender)).await.map_err(|_| StoreError::Closed)?;
        receiver.await.map_err(|_| StoreError::Closed)?
    }
}

struct Task {
    shared: Arc<Shared>,
    /// The pack that grows.
    open: Option<(u32, SqliteConnection)>,
}

impl Task {
    async fn run(mut self, mut queue: mpsc::Receiver<Call>) {
        let mut waiting = None;
        loop {
            let Some(call) = (match waiting.take() {
                Some(call) => Some(call),
                None => queue.recv().await,
            }) else {
                break;
            };
            // A caller may have gone away; its reply is then dropped.
            match call {
                Call::Put(blobs, answer) => waiting = self.put(blobs, answer, &mut queue).await,
                Call::Move(from, blobs, answer) => drop(answer.send(self.shift(from, blobs).await)),
                Call::Delete(digests, answer) => drop(answer.send(self.delete(digests).await)),
                Call::Remove(pack, answer) => drop(answer.send(self.remove(pack).await)),
            }
        }
        if let Some((_, connection)) = self.open.take()
            && let Err(error) = connection.close().await
        {
            tracing::warn!(%error, "the artifact pack did not close cleanly");
        }
    }

    /// Stores the blobs of this call and of those waiting behind it; returns the first call of another kind.
    async fn put(
        &mut self,
        mut blobs: Vec<Put>,
        answer: Answer<()>,
        queue: &mut mpsc::Receiver<Call>,
    ) -> Option<Call> {
        let mut answers = vec![answer];
        let mut other = None;
        while blobs.iter().map(|put| put.bytes.len()).sum::<usize>() < GROUP_BYTES {
            match queue.try_recv() {
                Ok(Call::Put(more, answer)) => {
                    blobs.extend(more);
                    answers.push(answer);
                }
                Ok(call) => {
                    other = Some(call);
                    break;
                }
                Err(_) => break,
            }
        }
        {
            let index = self.shared.index();
            blobs.retain(|blob| !index.holds(&blob.digest));
        }
        let result = self.store(blobs).await;
        for answer in answers {
            let _ = answer.send(result.clone());
        }
        other
    }

    async fn shift(&mut self, from: u32, mut blobs: Vec<Put>) -> Result<(), StoreError> {
        {
            let index = self.shared.index();
            let there = |digest: &Digest| index.place(digest).is_some_and(|place| place.pack == from);
            blobs.retain(|blob| there(&blob.digest));
        }
        self.store(blobs).await
    }

    async fn store(&mut self, mut blobs: Vec<Put>) -> Result<(), StoreError> {
        blobs.sort_unstable_by_key(|blob| blob.digest);
        blobs.dedup_by_key(|blob| blob.digest);
        if blobs.is_empty() {
            return Ok(());
        }
        let (pack, connection) = self.pack().await?;
        if let Err(error) = append(connection, &blobs).await {
            let error = StoreError::from(error);
            // Closing the connection would take the shared-memory file along that readers need, and on a full disk it
            // could not be made again. After any other fault begin afresh.
            if !matches!(error, StoreError::Full { .. }) {
                self.open = None;
            }
            if matches!(error, StoreError::Damaged { .. }) {
                self.shared.index().seal(pack);
            }
            return Err(error);
        }
        let mut stale: BTreeMap<u32, Vec<Digest>> = BTreeMap::new();
        {
            let mut index = self.shared.index();
            for blob in &blobs {
                let length = blob.bytes.len() as u64;
                if let Some(before) = index.insert(blob.digest, Place { pack, length })
                    && before.pack != pack
                {
                    stale.entry(before.pack).or_default().push(blob.digest);
                }
            }
        }
        faults::point("pack.moved");
        for (pack, digests) in stale {
            if let Err(error) = self.forget(pack, &digests).await {
                // The next start finds them twice and takes the newer.
                tracing::warn!(pack, %error, "old entries of a pack stay");
            }
        }
        Ok(())
    }

    /// The index first, so that no reader looks for an entry that is gone. What cannot be deleted is put back.
    async fn delete(&mut self, digests: Vec<Digest>) -> Result<u64, StoreError> {
        let mut gone: BTreeMap<u32, Vec<(Digest, Place)>> = BTreeMap::new();
        {
            let mut index = self.shared.index();
            for digest in digests {
                if let Some(place) = index.remove(&digest) {
                    gone.entry(place.pack).or_default().push((digest, place));
                }
            }
        }
        let (mut bytes, mut fault) = (0, None);
        for (pack, blobs) in gone {
            let digests: Vec<Digest> = blobs.iter().map(|(digest, _)| *digest).collect();
            match self.forget(pack, &digests).await {
                Ok(()) => bytes += blobs.iter().map(|(_, place)| place.length).sum::<u64>(),
                Err(StoreError::Damaged { message }) => {
                    tracing::warn!(
                        pack,
                        message,
                        "entries of a damaged pack come back with the next start"
                    );
                }
                Err(error) => {
                    let mut index = self.shared.index();
                    for (digest, place) in blobs {
                        index.insert(digest, place);
                    }
                    fault = Some(error);
                }
            }
        }
        fault.map_or(Ok(bytes), Err)
    }

    async fn forget(&mut self, pack: u32, digests: &[Digest]) -> Result<(), StoreError> {
        if let Some((open, connection)) = &mut self.open
            && *open == pack
        {
            return Ok(forget(connection, digests).await?);
        }
        let mut connection = self.shared.folder.resting(pack).await?;
        let forgotten = forget(&mut connection, digests).await;
        connection.close().await?;
        Ok(forgotten?)
    }

    async fn remove(&mut self, pack: u32) -> Result<bool, StoreError> {
        if !self.shared.index().remove_pack(pack) {
            return Ok(false);
        }
        if let Some((_, connection)) = self.open.take_if(|(open, _)| *open == pack) {
            connection.close().await?;
        }
        self.shared.readers.retire(pack);
        faults::point("pack.removing");
        self.shared.folder.remove(pack)?;
        faults::point("pack.removed");
        Ok(true)
    }

    /// The pack that grows; a new one when the last is full or must not grow.
    async fn pack(&mut self) -> Result<(u32, &mut SqliteConnection), StoreError> {
        let growing = self.shared.index().growing();
        let number = match growing {
            Some((pack, used)) if used.bytes < self.shared.pack_bytes => pack,
            _ => {
                let next = self.shared.index().next_number();
                self.shared.folder.create(next).await?;
                self.shared.index().add_pack(next);
                next
            }
        };
        if self.open.as_ref().is_none_or(|(open, _)| *open != number) {
            if let Some((full, mut connection)) = self.open.take() {
                self.shared.readers.let_go(full);
                fold_in(&mut connection).await;
                connection.close().await?;
            }
            self.open = Some((number, self.shared.folder.writer(number).await?));
        }
        let (_, connection) = self.open.as_mut().ok_or(StoreError::Closed)?;
        Ok((number, connection))
    }
}

async fn append(connection: &mut SqliteConnection, blobs: &[Put]) -> Result<(), sqlx::Error> {
    let committed = transaction(connection, async |connection| {
        for blob in blobs {
            append_one(connection, blob).await?;
        }
        faults::point("pack.written");
        Ok(())
    });
    committed.await?;
    faults::point("pack.committed");
    Ok(())
}

async fn append_one(connection: &mut SqliteConnection, blob: &Put) -> Result<(), sqlx::Error> {
    // Damaged bytes of this digest are replaced.
    sqlx::query("DELETE FROM entry WHERE digest = ?")
        .bind(&blob.digest.0[..])
        .execute(&mut *connection)
        .await?;
    let data = sqlx::query("INSERT INTO data (bytes) VALUES (?)")
        .bind(&blob.bytes)
        .execute(&mut *connection)
        .await?
        .last_insert_rowid();
    sqlx::query("INSERT INTO entry (digest, length, data) VALUES (?, ?, ?)")
        .bind(&blob.digest.0[..])
        .bind(blob.bytes.len() as i64)
        .bind(data)
        .execute(connection)
        .await?;
    Ok(())
}
