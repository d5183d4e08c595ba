//! Connections that read packs: few, kept open, shared by all packs.

use std::collections::HashSet;
use std::sync::{Mutex, MutexGuard, PoisonError};

use sqlx::{Connection, SqliteConnection};
use tokio::sync::Semaphore;

use crate::digest::Digest;
use crate::pack::Folder;

/// Maximum concurrent reads. Each connection has a thread, so this bounds threads; more reads would only queue at the
/// disk.
const MAX_READS: usize = 16;

/// Maximum idle connections over all packs; the least recently used is closed first.
const MAX_IDLE: usize = 16;

pub(crate) struct Readers {
    folder: Folder,
    permits: Semaphore,
    idle: Mutex<Idle>,
}

#[derive(Default)]
struct Idle {
    /// Oldest first.
    connections: Vec<(u32, SqliteConnection)>,
    /// Removed packs: an open connection would keep their disk space.
    retired: HashSet<u32>,
}

impl Readers {
    pub(crate) fn new(folder: Folder) -> Self {
        Self {
            folder,
            permits: Semaphore::new(MAX_READS),
            idle: Mutex::default(),
        }
    }

    /// Reads the stored bytes of a blob.
    pub(crate) async fn read(&self, pack: u32, digest: Digest) -> Result<Option<Vec<u8>>, sqlx::Error> {
        let Ok(_permit) = self.permits.acquire().await else {
            return Err(sqlx::Error::PoolClosed);
        };
        let mut connection = match self.take(pack) {
            Some(connection) => connection,
            None => self.folder.open_reader(pack).await?,
        };
        let bytes = sqlx::query_scalar(
            "SELECT data.bytes FROM entry JOIN data ON data.id = entry.data WHERE entry.digest = ?1",
        )
        .bind(&digest.0[..])
        .fetch_optional(&mut connection)
        .await?;
        self.keep(pack, connection);
        Ok(bytes)
    }

    /// Closes the idle connections to a pack.
    pub(crate) fn close_idle(&self, pack: u32) {
        self.idle().connections.retain(|(other, _)| *other != pack);
    }

    /// Closes the idle connections to a pack now, and busy ones when their read ends.
    pub(crate) fn retire(&self, pack: u32) {
        self.idle().retired.insert(pack);
        self.close_idle(pack);
    }

    /// Closes all idle connections.
    pub(crate) async fn close(&self) {
        let idle = std::mem::take(&mut self.idle().connections);
        for (pack, connection) in idle {
            if let Err(error) = connection.close().await {
                tracing::warn!(pack, %error, "a reader of an artifact pack did not close cleanly");
            }
        }
    }

    fn take(&self, pack: u32) -> Option<SqliteConnection> {
        let connections = &mut self.idle().connections;
        let position = connections.iter().rposition(|(other, _)| *other == pack)?;
        Some(connections.remove(position).1)
    }

    fn keep(&self, pack: u32, connection: SqliteConnection) {
        let mut idle = self.idle();
        if idle.retired.contains(&pack) {
            return;
        }
        idle.connections.push((pack, connection));
        if idle.connections.len() > MAX_IDLE {
            idle.connections.remove(0);
        }
    }

    fn idle(&self) -> MutexGuard<'_, Idle> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
