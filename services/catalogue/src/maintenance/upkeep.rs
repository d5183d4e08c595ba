//! Backup, integrity check, sizes.

use std::fs::File;
use std::path::Path;

use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{ConnectOptions, Connection};

use crate::catalogue::Catalogue;
use crate::error::CatalogueError;
use crate::open::wal_path;

/// Most findings of one kind, the limit of SQLite's list; a damaged file may have millions.
pub(crate) const MOST_FINDINGS: u32 = 100;

impl Catalogue {
    /// Writes and syncs a page without a change of content, to find out whether writes work.
    ///
    /// # Errors
    /// [`CatalogueError::Unwritable`], [`CatalogueError::Full`].
    pub async fn check_writes(&self) -> Result<(), CatalogueError> {
        self.write(|c| {
            Box::pin(async move {
                sqlx::query("PRAGMA user_version = 0").execute(c).await?;
                Ok(())
            })
        })
        .await
    }

    /// Writes a consistent copy while the service runs. The file appears whole or not at all; one that is there stays.
    ///
    /// # Errors
    /// [`CatalogueError::Failed`], also when the file is there; [`CatalogueError::Full`].
    pub async fn backup(&self, to: &Path) -> Result<(), CatalogueError> {
        let failed = |error: std::io::Error| CatalogueError::Failed {
            message: format!("{}: {error}", to.display()),
        };
        if to.exists() {
            return Err(failed(std::io::ErrorKind::AlreadyExists.into()));
        }
        let unfinished = to.with_extension("unfinished");
        if unfinished.exists() {
            std::fs::remove_file(&unfinished).map_err(failed)?;
        }
        let mut connection = self.apart().await?;
        let copied = sqlx::query("VACUUM INTO ?")
            .bind(unfinished.display().to_string())
            .execute(&mut connection)
            .await;
        connection.close().await?;
        if let Err(error) = copied {
            let _ = std::fs::remove_file(&unfinished);
            return Err(error.into());
        }
        without_replica(&unfinished).await?;
        let settle = || {
            File::open(&unfinished)?.sync_all()?;
            std::fs::rename(&unfinished, to)?;
            File::open(
                to.parent()
                    .filter(|folder| !folder.as_os_str().is_empty())
                    .unwrap_or(Path::new(".")),
            )?
            .sync_all()
        };
        settle().map_err(failed)
    }

    /// Damage of the file or of the sums in it. Reads the whole catalogue.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn integrity_check(&self) -> Result<Vec<String>, CatalogueError> {
        let mut connection = self.apart().await?;
        let findings = findings(&mut connection).await?;
        connection.close().await?;
        Ok(findings)
    }

    /// Bytes of the write-ahead log.
    #[must_use]
    pub fn wal_bytes(&self) -> u64 {
        std::fs::metadata(wal_path(&self.path)).map_or(0, |file| file.len())
    }

    /// A connection for a long operation, outside of the pool of readers.
    pub(crate) async fn apart(&self) -> Result<SqliteConnection, CatalogueError> {
        let options = SqliteConnectOptions::new().filename(&self.path);
        Ok(options.disable_statement_logging().connect().await?)
    }
}

/// The copy has no files of a replica, and its rows may have other rowids.
async fn without_replica(copy: &Path) -> Result<(), CatalogueError> {
    let options = SqliteConnectOptions::new()
        .filename(copy)
        .disable_statement_logging();
    let mut connection = options.connect().await?;
    let gone = sqlx::query("DELETE FROM mirror_files")
        .execute(&mut connection)
        .await;
    connection.close().await?;
    Ok(gone.map(drop)?)
}

async fn findings(connection: &mut SqliteConnection) -> Result<Vec<String>, CatalogueError> {
    // All of it sees one state of the catalogue.
    let mut transaction = connection.begin().await?;
    let mut findings: Vec<String> = sqlx::query_scalar("PRAGMA integrity_check")
        .fetch_all(&mut *transaction)
        .await?;
    findings.retain(|finding| finding != "ok");
    let dangling: Vec<String> = sqlx::query_scalar(
        "SELECT \"table\" || ' has a row of a ' || parent || ' that is not there' FROM pragma_foreign_key_check LIMIT ?",
    )
    .bind(MOST_FINDINGS)
    .fetch_all(&mut *transaction)
    .await?;
    findings.extend(dangling);
    for (what, sql) in SUMS {
        let wrong: Vec<String> = sqlx::query_scalar(sql)
            .bind(MOST_FINDINGS)
            .fetch_all(&mut *transaction)
            .await?;
        findings.extend(wrong.into_iter().map(|name| format!("{what} of {name}")));
    }
    transaction.rollback().await?;
    Ok(findings)
}

/// Counters and the rows that they count.
const SUMS: [(&str, &str); 7] = [
    (
        "counted images",
        "SELECT id FROM jobs WHERE id NOT IN (SELECT job_id FROM deletions)
             AND done != (SELECT count(*) FROM images WHERE job_id = jobs.id) LIMIT ?",
    ),
    (
        "counted failures",
        "SELECT id FROM jobs WHERE id NOT IN (SELECT job_id FROM deletions)
             AND failed != (SELECT count(*) FROM failures WHERE job_id = jobs.id AND quarantined = 1) LIMIT ?",
    ),
    (
        "counted bytes",
        "SELECT id FROM jobs WHERE id NOT IN (SELECT job_id FROM deletions)
             AND bytes != (SELECT coalesce(sum(bytes), 0) FROM artifacts WHERE job_id = jobs.id) LIMIT ?",
    ),
    (
        "records",
        "SELECT id FROM jobs WHERE id NOT IN (SELECT job_id FROM deletions)
             AND done != (SELECT count(*) FROM records WHERE job_id = jobs.id) LIMIT ?",
    ),
    (
        "state",
        "SELECT id FROM jobs WHERE (done + failed >= frames) = (state IN ('queued', 'running', 'paused'))
             AND state != 'cancelled' LIMIT ?",
    ),
    (
        "places in tars",
        "SELECT DISTINCT job_id FROM artifacts WHERE tar_offset IS NOT NULL
             AND NOT EXISTS (SELECT 1 FROM shards
                             WHERE shards.job_id = artifacts.job_id AND shards.frame <= artifacts.frame)
             AND job_id NOT IN (SELECT job_id FROM deletions) LIMIT ?",
    ),
    (
        "sums of dataset",
        "SELECT name FROM datasets WHERE (jobs, images, bytes) !=
             (SELECT count(*), coalesce(sum(done), 0), coalesce(sum(bytes), 0) FROM jobs
              WHERE dataset = name AND id NOT IN (SELECT job_id FROM deletions)) LIMIT ?",
    ),
];
