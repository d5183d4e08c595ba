//! The task that writes.

use std::collections::BTreeMap;
use std::sync::Arc;

use sqlx::{Connection, SqliteConnection};
use tokio::sync::mpsc;

use super::call::{Call, CheckedBlob, GROUP_BYTES, Reply, Shared};
use crate::digest::Digest;
use crate::error::StoreError;
use crate::index::Location;
use crate::pack::{delete_entries, remove_log, touch, transaction};

pub(super) struct Task {
    pub(super) shared: Arc<Shared>,
    /// The open pack.
    pub(super) open: Option<(u32, SqliteConnection)>,
}

impl Task {
    pub(super) async fn run(mut self, mut queue: mpsc::Receiver<Call>) {
        let mut waiting = None;
        loop {
            let Some(call) = (match waiting.take() {
                Some(call) => Some(call),
                None => queue.recv().await,
            }) else {
                break;
            };
            // If the caller was dropped, so is its reply.
            match call {
                Call::Put(blobs, reply) => waiting = self.put(blobs, reply, &mut queue).await,
                Call::Move(from, blobs, reply) => drop(reply.send(self.move_blobs(from, blobs).await)),
                Call::Delete(digests, reply) => drop(reply.send(self.delete(digests).await)),
                Call::Check(reply) => drop(reply.send(self.check_writes().await)),
                Call::Remove(pack, reply) => drop(reply.send(self.remove(pack).await)),
            }
        }
        if let Some((_, connection)) = self.open.take()
            && let Err(error) = connection.close().await
        {
            tracing::warn!(%error, "the artifact pack did not close cleanly");
        }
    }

    /// Stores the blobs of this call and of queued calls of the same kind; returns the first queued call of another
    /// kind.
    async fn put(
        &mut self,
        mut blobs: Vec<CheckedBlob>,
        reply: Reply<()>,
        queue: &mut mpsc::Receiver<Call>,
    ) -> Option<Call> {
        let mut replies = vec![reply];
        let mut other = None;
        while blobs.iter().map(|put| put.bytes.len()).sum::<usize>() < GROUP_BYTES {
            match queue.try_recv() {
                Ok(Call::Put(more, reply)) => {
                    blobs.extend(more);
                    replies.push(reply);
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
        for reply in replies {
            let _ = reply.send(result.clone());
        }
        other
    }

    async fn move_blobs(&mut self, from: u32, mut blobs: Vec<CheckedBlob>) -> Result<(), StoreError> {
        {
            let index = self.shared.index();
            blobs.retain(|blob| index.locate(&blob.digest).is_some_and(|found| found.pack == from));
        }
        self.store(blobs).await
    }

    async fn store(&mut self, mut blobs: Vec<CheckedBlob>) -> Result<(), StoreError> {
        blobs.sort_unstable_by_key(|blob| blob.digest);
        blobs.dedup_by_key(|blob| blob.digest);
        if blobs.is_empty() {
            return Ok(());
        }
        let (pack, connection) = self.pack().await?;
        if let Err(error) = append(connection, &blobs).await {
            let error = StoreError::from(error);
            // Closing the connection removes the shared-memory file that readers need, and a full disk has no space
            // for a new one. After any other error reconnect.
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
                if let Some(before) = index.insert(blob.digest, Location { pack, length })
                    && before.pack != pack
                {
                    stale.entry(before.pack).or_default().push(blob.digest);
                }
            }
        }
        faults::point("pack.moved");
        for (pack, digests) in stale {
            if let Err(error) = self.delete_entries(pack, &digests).await {
                // The next start finds both entries and keeps the newer.
                tracing::warn!(pack, %error, "could not delete the old entries of a pack");
            }
        }
        Ok(())
    }

    async fn check_writes(&mut self) -> Result<(), StoreError> {
        let (_, connection) = self.pack().await?;
        let written = touch(connection).await.map_err(StoreError::from);
        if matches!(&written, Err(error) if !matches!(error, StoreError::Full { .. })) {
            self.open = None;
        }
        written
    }

    /// Removes blobs from the index first, so that no reader looks for a deleted entry. Failed deletions are
    /// restored.
    async fn delete(&mut self, digests: Vec<Digest>) -> Result<u64, StoreError> {
        let mut gone: BTreeMap<u32, Vec<(Digest, Location)>> = BTreeMap::new();
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
            match self.delete_entries(pack, &digests).await {
                Ok(()) => bytes += blobs.iter().map(|(_, place)| place.length).sum::<u64>(),
                Err(StoreError::Damaged { message }) => {
                    tracing::warn!(
                        pack,
                        message,
                        "could not delete entries of a damaged pack; they reappear at the next start"
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

    async fn delete_entries(&mut self, pack: u32, digests: &[Digest]) -> Result<(), StoreError> {
        if let Some((open, connection)) = &mut self.open
            && *open == pack
        {
            return Ok(delete_entries(connection, digests).await?);
        }
        let mut connection = self.shared.folder.open_sealed(pack).await?;
        let forgotten = delete_entries(&mut connection, digests).await;
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

    /// Returns the open pack; creates one if the last is full or sealed.
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
                self.shared.readers.close_idle(full);
                remove_log(&mut connection).await;
                connection.close().await?;
            }
            self.open = Some((number, self.shared.folder.open_writer(number).await?));
        }
        let (_, connection) = self.open.as_mut().ok_or(StoreError::Closed)?;
        Ok((number, connection))
    }
}

async fn append(connection: &mut SqliteConnection, blobs: &[CheckedBlob]) -> Result<(), sqlx::Error> {
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

async fn append_one(connection: &mut SqliteConnection, blob: &CheckedBlob) -> Result<(), sqlx::Error> {
    // Replaces damaged bytes of this digest.
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
