//! Opening and closing: connections, migrations, wide columns.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicU64;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use sqlx::ConnectOptions;
use sqlx::migrate::MigrateError;
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqlitePoolOptions, SqliteSynchronous};

use crate::catalogue::Catalogue;
use crate::commit::writer::Writer;
use crate::damage::DamageLog;
use crate::digests::row_digests;
use crate::error::CatalogueError;
use crate::query::cache::JobCache;
use crate::query::columns::Columns;
use crate::replica::files as replica_files;
use crate::replica::files::Replica;
use crate::schema::backfill::{add_columns, backfill};
use crate::schema::migrations::migrator;

/// Earlier versions can damage the write-ahead log when it is reset.
const LEAST_SQLITE: &str = "3.51.3";
/// Questions that run side by side; more would only compete for the same cache.
const READERS: u32 = 8;
/// Page cache of a connection, in KiB with SQLite's minus sign: digests are spread over their index, and the default of 2 MB holds
/// too few of its pages.
const CACHE: &str = "-32768";
/// Page cache of each reader; smaller, since there are several and the system caches pages, too.
const READER_CACHE: &str = "-8192";
/// Rows that a reader's thread may be ahead: each time it stops costs a change of threads, and with 50 that
/// is most of a query over a million rows.
const ROWS: usize = 2048;
/// How long a connection waits for a lock of another process, such as a backup.
const LOCK_WAIT: Duration = Duration::from_secs(5);
/// How long a query waits for a reader.
const READER_WAIT: Duration = Duration::from_secs(10);

impl Catalogue {
    /// Opens or creates a catalogue whose images have these metrics (`uiqm`, `uiqm@table1`, …).
    ///
    /// # Errors
    /// [`CatalogueError::Open`], [`CatalogueError::SqliteTooOld`].
    pub async fn open(path: &Path, metrics: &[String]) -> Result<Self, CatalogueError> {
        let unusable = |error: &dyn std::fmt::Display| CatalogueError::Open {
            path: path.to_owned(),
            reason: error.to_string(),
        };
        let options = SqliteConnectOptions::new()
            .filename(path)
            .create_if_missing(true)
            .journal_mode(SqliteJournalMode::Wal)
            .synchronous(SqliteSynchronous::Full)
            .foreign_keys(true)
            .busy_timeout(LOCK_WAIT)
            .pragma("cache_size", CACHE)
            // The writer checkpoints the log after its reply; the log then starts at the beginning, so its size is its length.
            .pragma("wal_autocheckpoint", "0")
            .pragma("journal_size_limit", "0")
            .disable_statement_logging();
        let mut connection = options.connect().await.map_err(|e| unusable(&e))?;
        let version: String = sqlx::query_scalar("SELECT sqlite_version()")
            .fetch_one(&mut connection)
            .await?;
        if numbers(&version) < numbers(LEAST_SQLITE) {
            return Err(CatalogueError::SqliteTooOld {
                version,
                least: LEAST_SQLITE,
            });
        }
        migrator()
            .run(&mut connection)
            .await
            .map_err(|error| match error {
                MigrateError::VersionMissing(version) => {
                    unusable(&format!("a newer program wrote it (schema {version})"))
                }
                other => unusable(&other),
            })?;
        let columns = Columns::new(metrics);
        add_columns(&mut connection, &columns).await?;
        row_digests::prepare(&mut connection).await?;
        backfill(&mut connection, &columns).await?;
        replica_files::keep_files_with_columns(&mut connection, &columns.replica_digest()).await?;
        let readers = SqlitePoolOptions::new()
            .max_connections(READERS)
            .acquire_timeout(READER_WAIT)
            .connect_with(
                options
                    .pragma("cache_size", READER_CACHE)
                    .pragma("query_only", "ON")
                    .row_buffer_size(ROWS),
            )
            .await
            .map_err(|e| unusable(&e))?;
        let (writer, task) = Writer::start(connection, columns.clone(), wal_path(path));
        Ok(Self {
            path: path.to_owned(),
            columns,
            replica: Arc::new(Replica::of_catalogue(path)),
            job_cache: JobCache::default(),
            readers,
            reads: AtomicU64::new(0),
            damage: DamageLog::default(),
            writer: Mutex::new(Some(writer)),
            task: Mutex::new(Some(task)),
        })
    }

    /// Stops the writer after its accepted changes, and closes all connections.
    pub async fn close(&self) {
        drop(self.writer.lock().unwrap_or_else(PoisonError::into_inner).take());
        let task = self.task.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(task) = task {
            let _ = task.await;
        }
        self.readers.close().await;
    }
}

/// Where SQLite keeps the write-ahead log.
pub(crate) fn wal_path(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push("-wal");
    name.into()
}

fn numbers(version: &str) -> Vec<u32> {
    version.split('.').map(|part| part.parse().unwrap_or(0)).collect()
}
