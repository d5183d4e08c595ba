//! One pack: file name, tables, creation and format check.

use std::path::{Path, PathBuf};
use std::time::Duration;

use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqliteSynchronous};
use sqlx::{AssertSqlSafe, ConnectOptions, Connection, Executor, SqliteConnection};

use crate::digest::Digest;
use crate::error::StoreError;

/// With large pages a blob of some hundred kilobytes needs few of them: 3 to 4 times faster than 4 KiB pages.
const PAGE_BYTES: u32 = 65536;

/// "FTHM" in the header of every pack distinguishes it from any other SQLite file.
const APPLICATION_ID: i64 = 0x4654_484d;

/// Version of the tables below.
const FORMAT: i64 = 1;

/// How long a connection waits for a lock. Only the checkpoint at the end of a pack has to wait.
const BUSY: Duration = Duration::from_secs(5);

/// `entry` is small and holds the rows read at start; the bytes are in a separate table, so that a start does not
/// read them.
const TABLES: &str = "
    CREATE TABLE data (id INTEGER PRIMARY KEY, bytes BLOB NOT NULL) STRICT;
    CREATE TABLE entry (
        digest BLOB NOT NULL PRIMARY KEY,
        length INTEGER NOT NULL,
        data INTEGER NOT NULL REFERENCES data (id)
    ) STRICT, WITHOUT ROWID;
";

#[derive(Debug, Clone)]
pub(crate) struct Folder(pub(crate) PathBuf);

impl Folder {
    pub(crate) fn path(&self, pack: u32) -> PathBuf {
        self.0.join(format!("pack-{pack:06}.sqlite"))
    }

    /// Returns the numbers of the existing packs, in order, and removes the remains of crashed writes.
    pub(crate) fn packs(&self) -> Result<Vec<u32>, StoreError> {
        let mut packs = Vec::new();
        for entry in std::fs::read_dir(&self.0)? {
            let entry = entry?;
            let name = entry.file_name();
            let Some(name) = name.to_str() else { continue };
            let without_pack = [".sqlite-wal", ".sqlite-shm", ".sqlite-journal"]
                .iter()
                .filter_map(|end| name.strip_suffix(end))
                .any(|pack| !self.0.join(format!("{pack}.sqlite")).exists());
            if name.contains(".sqlite.new") || without_pack {
                // SQLite would apply a log without a pack to the next pack of this number.
                std::fs::remove_file(entry.path())?;
            } else if let Some(number) = name
                .strip_prefix("pack-")
                .and_then(|name| name.strip_suffix(".sqlite"))
            {
                let number = number
                    .parse()
                    .map_err(|_| StoreError::pack(&entry.path(), "the file name has no pack number"))?;
                packs.push(number);
            }
        }
        packs.sort_unstable();
        Ok(packs)
    }

    /// Creates an empty pack atomically.
    pub(crate) async fn create(&self, pack: u32) -> Result<(), StoreError> {
        let path = self.path(pack);
        let unfinished = path.with_extension("sqlite.new");
        // An attempt on a full disk may have left a partial file.
        if unfinished.exists() {
            std::fs::remove_file(&unfinished)?;
        }
        let options = self.options(pack).filename(&unfinished).create_if_missing(true);
        let mut connection = options.page_size(PAGE_BYTES).connect().await?;
        let statements = format!(
            "BEGIN; {TABLES} PRAGMA application_id = {APPLICATION_ID}; PRAGMA user_version = {FORMAT}; COMMIT;"
        );
        sqlx::raw_sql(AssertSqlSafe(statements))
            .execute(&mut connection)
            .await?;
        connection.close().await?;
        std::fs::rename(&unfinished, &path)?;
        self.sync()
    }

    /// Opens a writing connection: WAL, so that readers are not blocked; FULL, so that a commit is durable.
    pub(crate) async fn open_writer(&self, pack: u32) -> Result<SqliteConnection, sqlx::Error> {
        self.options(pack)
            .journal_mode(SqliteJournalMode::Wal)
            .connect()
            .await
    }

    /// Opens a closed pack and folds its log into it, so that reading needs no other file, which a full disk could
    /// not hold.
    pub(crate) async fn open_sealed(&self, pack: u32) -> Result<SqliteConnection, sqlx::Error> {
        let mut connection = self.open_plain(pack).await?;
        remove_log(&mut connection).await;
        Ok(connection)
    }

    /// Opens a pack without changing its journal mode.
    pub(crate) async fn open_plain(&self, pack: u32) -> Result<SqliteConnection, sqlx::Error> {
        self.options(pack).connect().await
    }

    /// Opens a read-only connection.
    pub(crate) async fn open_reader(&self, pack: u32) -> Result<SqliteConnection, sqlx::Error> {
        self.options(pack).pragma("query_only", "1").connect().await
    }

    fn options(&self, pack: u32) -> SqliteConnectOptions {
        SqliteConnectOptions::new()
            .filename(self.path(pack))
            .busy_timeout(BUSY)
            .synchronous(SqliteSynchronous::Full)
            .disable_statement_logging()
    }

    /// Renames an unreadable pack and keeps it for inspection.
    pub(crate) fn set_aside(&self, pack: u32) -> Result<(), StoreError> {
        let path = self.path(pack);
        let damaged = path.with_extension("sqlite.damaged");
        for end in ["", "-wal", "-shm"] {
            let file = suffixed(&path, end);
            if file.exists() {
                std::fs::rename(file, suffixed(&damaged, end))?;
            }
        }
        self.sync()
    }

    pub(crate) fn remove(&self, pack: u32) -> Result<(), StoreError> {
        let path = self.path(pack);
        std::fs::remove_file(&path)?;
        for end in ["-wal", "-shm"] {
            match std::fs::remove_file(suffixed(&path, end)) {
                Err(error) if error.kind() != std::io::ErrorKind::NotFound => return Err(error.into()),
                _ => {}
            }
        }
        self.sync()
    }

    /// Size of a pack on disk, bytes.
    pub(crate) fn size(&self, pack: u32) -> Result<u64, StoreError> {
        Ok(std::fs::metadata(self.path(pack))?.len())
    }

    pub(crate) fn sync(&self) -> Result<(), StoreError> {
        Ok(std::fs::File::open(&self.0)?.sync_all()?)
    }
}

/// SQLite's name for a companion file of a database.
fn suffixed(path: &Path, end: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(end);
    name.into()
}

/// Removes the write-ahead log of a closed pack. If a reader blocks this the log stays, which matters only on a full
/// disk.
pub(crate) async fn remove_log(connection: &mut SqliteConnection) {
    let folded =
        sqlx::raw_sql("PRAGMA busy_timeout = 200; PRAGMA journal_mode = DELETE; PRAGMA busy_timeout = 5000;")
            .execute(connection)
            .await;
    if let Err(error) = folded {
        tracing::debug!(%error, "could not remove the log of a pack yet");
    }
}

/// Deletes entries of a pack; their bytes stay until the pack is rewritten.
pub(crate) async fn delete_entries(
    connection: &mut SqliteConnection,
    digests: &[Digest],
) -> Result<(), sqlx::Error> {
    transaction(connection, async |connection| {
        for digest in digests {
            let entry = sqlx::query("DELETE FROM entry WHERE digest = ?").bind(&digest.0[..]);
            entry.execute(&mut *connection).await?;
        }
        Ok(())
    })
    .await
}

/// Runs a change in a transaction. A sqlx transaction does not recover after SQLite rolls back on its side, as it
/// does on a full disk.
pub(crate) async fn transaction(
    connection: &mut SqliteConnection,
    change: impl AsyncFnOnce(&mut SqliteConnection) -> Result<(), sqlx::Error>,
) -> Result<(), sqlx::Error> {
    connection.execute("BEGIN IMMEDIATE").await?;
    let mut done = change(connection).await;
    if done.is_ok() {
        done = connection.execute("COMMIT").await.map(drop);
    }
    if done.is_err() {
        let _ = connection.execute("ROLLBACK").await;
    }
    done
}

/// Writes and syncs a page without a change of content.
pub(crate) async fn touch(connection: &mut SqliteConnection) -> Result<(), sqlx::Error> {
    let statement = format!("PRAGMA user_version = {FORMAT}");
    transaction(connection, async |connection| {
        connection
            .execute(AssertSqlSafe(statement.as_str()))
            .await
            .map(drop)
    })
    .await
}

/// Rejects a file that is not a pack of this format.
pub(crate) async fn check(connection: &mut SqliteConnection, path: &Path) -> Result<(), StoreError> {
    let id: i64 = sqlx::query_scalar("PRAGMA application_id")
        .fetch_one(&mut *connection)
        .await?;
    if id != APPLICATION_ID {
        return Err(StoreError::pack(path, "it is another SQLite database"));
    }
    let format: i64 = sqlx::query_scalar("PRAGMA user_version")
        .fetch_one(connection)
        .await?;
    if format != FORMAT {
        return Err(StoreError::pack(
            path,
            format!("its format is {format}; this program reads format {FORMAT}"),
        ));
    }
    Ok(())
}
