//! Connections that read packs: few, kept open, shared by all packs.

use std::sync::{Mutex, MutexGuard, PoisonError};

use sqlx::SqliteConnection;
use tokio::sync::Semaphore;

use crate::digest::Digest;
use crate::pack::Folder;

/// Reads at one time. Each connection has a thread, so this bounds threads; more only queue at the disk.
const AT_ONCE: usize = 16;

/// Connections kept open while idle, whichever pack they belong to; the one unused longest goes first.
const IDLE: usize = 16;

pub(crate) struct Readers {
    folder: Folder,
    permits: Semaphore,
    /// Oldest first.
    idle: Mutex<Vec<(u32, SqliteConnection)>>,
}

impl Readers {
    pub(crate) fn new(folder: Folder) -> Self {
        Self {
            folder,
            permits: Semaphore::new(AT_ONCE),
            idle: Mutex::default(),
        }
    }

    /// The bytes of a blob in this pack, as they are stored.
    pub(crate) async fn read(&self, pack: u32, digest: Digest) -> Result<Option<Vec<u8>>, sqlx::Error> {
        let Ok(_permit) = self.permits.acquire().await else {
            return Err(sqlx::Error::PoolClosed);
        };
        let mut connection = match self.take(pack) {
            Some(connection) => connection,
            None => self.folder.reader(pack).await?,
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

    fn take(&self, pack: u32) -> Option<SqliteConnection> {
        let mut idle = self.idle();
        let position = idle.iter().rposition(|(other, _)| *other == pack)?;
        Some(idle.remove(position).1)
    }

    fn keep(&self, pack: u32, connection: SqliteConnection) {
        let mut idle = self.idle();
        idle.push((pack, connection));
        if idle.len() > IDLE {
            idle.remove(0);
        }
    }

    fn idle(&self) -> MutexGuard<'_, Vec<(u32, SqliteConnection)>> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
