//! Deletion of jobs of any size without blocking the writer.
//!
//! There are three durable steps, each continued after a crash. A job is hidden together with its images. Its rows are deleted in
//! small transactions, and the digests in them become orphans. Orphans without another reference are deleted from the artifact
//! store, then from the list.

use client::Deleted;
use sqlx::sqlite::{SqliteConnection, SqliteQueryResult};
use sqlx::{AssertSqlSafe, Row};

use crate::catalogue::Catalogue;
use crate::datasets::versions::refuse_sealed;
use crate::error::CatalogueError;
use crate::replica::files as replica_files;

/// Rows of one table that one transaction removes: some 20 ms of the writer's time.
const SWEEP_ROWS: u32 = 1000;

impl Catalogue {
    /// Hides a job in any state with its images, and frees its idempotency keys. [`Catalogue::sweep`] deletes the rows.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`]; [`CatalogueError::Sealed`].
    pub async fn delete_job(&self, id: &str) -> Result<Deleted, CatalogueError> {
        let id = id.to_owned();
        self.write(move |c| Box::pin(async move { hide_job(c, &id).await }))
            .await
    }

    /// Hides a dataset with all its jobs and images.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`]; [`CatalogueError::Transition`] naming a job of it that has not ended; [`CatalogueError::Sealed`].
    pub async fn delete_dataset(&self, name: &str) -> Result<Deleted, CatalogueError> {
        let name = name.to_owned();
        self.write(move |c| Box::pin(async move { hide_dataset(c, &name).await }))
            .await
    }

    /// Removes some rows of hidden jobs, in one short transaction. Returns whether any remain: call it until
    /// none are, after each deletion and after each start.
    ///
    /// # Errors
    /// [`CatalogueError::Full`].
    pub async fn sweep(&self) -> Result<bool, CatalogueError> {
        self.write(|c| Box::pin(sweep(c))).await
    }

    /// Digests whose last reference was deleted. After the artifact store has deleted their bytes, [`Catalogue::forget_orphans`] removes
    /// them from the list. No image may be stored between the two calls, since it might refer to one of them.
    ///
    /// # Errors
    /// [`CatalogueError::Full`].
    pub async fn orphans(&self, limit: u32) -> Result<Vec<String>, CatalogueError> {
        self.write(move |c| Box::pin(orphans(c, limit))).await
    }

    /// Takes digests off the list of orphans.
    ///
    /// # Errors
    /// [`CatalogueError::Full`].
    pub async fn forget_orphans(&self, digests: Vec<String>) -> Result<(), CatalogueError> {
        self.write(move |c| Box::pin(async move { forget(c, &digests).await }))
            .await
    }
}

async fn hide_job(connection: &mut SqliteConnection, id: &str) -> Result<Deleted, CatalogueError> {
    let found = sqlx::query(
        "SELECT dataset, done, bytes FROM jobs WHERE id = ? AND id NOT IN (SELECT job_id FROM deletions)",
    )
    .bind(id)
    .fetch_optional(&mut *connection)
    .await?;
    let job = found.ok_or_else(|| CatalogueError::not_found("job", id))?;
    refuse_sealed(connection, id).await?;
    let (dataset, images, bytes): (String, i64, i64) = (job.try_get(0)?, job.try_get(1)?, job.try_get(2)?);
    sqlx::query("INSERT INTO deletions (job_id) VALUES (?)")
        .bind(id)
        .execute(&mut *connection)
        .await?;
    sqlx::query("DELETE FROM idempotency_keys WHERE job_id = ?")
        .bind(id)
        .execute(&mut *connection)
        .await?;
    sqlx::query("UPDATE datasets SET jobs = jobs - 1, images = images - ?, bytes = bytes - ? WHERE name = ?")
        .bind(images)
        .bind(bytes)
        .bind(&dataset)
        .execute(&mut *connection)
        .await?;
    sqlx::query("DELETE FROM datasets WHERE name = ? AND jobs = 0")
        .bind(dataset)
        .execute(connection)
        .await?;
    Ok(Deleted {
        jobs: 1,
        images: images as u64,
        bytes: bytes as u64,
    })
}

async fn hide_dataset(connection: &mut SqliteConnection, name: &str) -> Result<Deleted, CatalogueError> {
    let jobs: Vec<(String, String)> = sqlx::query_as(
        "SELECT id, state FROM jobs WHERE dataset = ? AND id NOT IN (SELECT job_id FROM deletions)",
    )
    .bind(name)
    .fetch_all(&mut *connection)
    .await?;
    if jobs.is_empty() {
        return Err(CatalogueError::not_found("dataset", name));
    }
    if let Some((id, state)) = jobs
        .iter()
        .find(|(_, state)| matches!(state.as_str(), "queued" | "running" | "paused"))
    {
        return Err(CatalogueError::Transition {
            id: id.clone(),
            from: state.clone(),
            to: "deleted with its dataset".to_owned(),
        });
    }
    let mut all = Deleted::default();
    for (id, _) in jobs {
        let Deleted { jobs, images, bytes } = hide_job(connection, &id).await?;
        all.jobs += jobs;
        all.images += images;
        all.bytes += bytes;
    }
    Ok(all)
}

/// The tables with rows of frames, in the order of deletion: after a crash between two transactions every unreferenced digest is an
/// orphan.
const OF_FRAMES: [&str; 7] = [
    "deliveries",
    "artifacts",
    "measurements",
    "failures",
    "records",
    "images",
    "shards",
];

async fn sweep(connection: &mut SqliteConnection) -> Result<bool, CatalogueError> {
    let job: Option<String> = sqlx::query_scalar("SELECT job_id FROM deletions LIMIT 1")
        .fetch_optional(&mut *connection)
        .await?;
    let Some(job) = job else { return Ok(false) };
    for table in OF_FRAMES {
        let end = end_of_batch(connection, table, &job).await?;
        if table == "artifacts" {
            sqlx::query(
                "INSERT OR IGNORE INTO orphans (digest)
                 SELECT digest FROM artifacts WHERE job_id = ? AND frame <= ? AND tar_offset IS NULL",
            )
            .bind(&job)
            .bind(end)
            .execute(&mut *connection)
            .await?;
        }
        let sql = format!("DELETE FROM {table} WHERE job_id = ? AND frame <= ?");
        let gone: SqliteQueryResult = sqlx::query(AssertSqlSafe(sql))
            .bind(&job)
            .bind(end)
            .execute(&mut *connection)
            .await?;
        if table == "images" && gone.rows_affected() > 0 {
            replica_files::drop_rows(connection, &job).await?;
        }
        if gone.rows_affected() > 0 {
            return Ok(true);
        }
    }
    sqlx::query("DELETE FROM jobs WHERE id = ?")
        .bind(&job)
        .execute(&mut *connection)
        .await?;
    sqlx::query("DELETE FROM deletions WHERE job_id = ?")
        .bind(&job)
        .execute(&mut *connection)
        .await?;
    let more = sqlx::query_scalar("SELECT EXISTS (SELECT 1 FROM deletions)");
    Ok(more.fetch_one(connection).await?)
}

/// The last frame of the next batch. A frame's rows go together, so a batch may be a little larger than its limit.
async fn end_of_batch(
    connection: &mut SqliteConnection,
    table: &str,
    job: &str,
) -> Result<i64, CatalogueError> {
    let sql = format!("SELECT frame FROM {table} WHERE job_id = ? ORDER BY frame LIMIT 1 OFFSET ?");
    let frame: Option<i64> = sqlx::query_scalar(AssertSqlSafe(sql))
        .bind(job)
        .bind(SWEEP_ROWS)
        .fetch_optional(connection)
        .await?;
    Ok(frame.unwrap_or(i64::MAX))
}

async fn orphans(connection: &mut SqliteConnection, limit: u32) -> Result<Vec<String>, CatalogueError> {
    loop {
        let rows: Vec<(String, bool)> = sqlx::query_as(
            "SELECT digest, EXISTS (SELECT 1 FROM artifacts a WHERE a.digest = orphans.digest AND a.tar_offset IS NULL)
                         OR EXISTS (SELECT 1 FROM scenes WHERE rgb_digest = orphans.digest)
                         OR EXISTS (SELECT 1 FROM scenes WHERE range_digest = orphans.digest)
                         OR EXISTS (SELECT 1 FROM scenes WHERE instances_digest = orphans.digest)
             FROM orphans LIMIT ?",
        )
        .bind(limit)
        .fetch_all(&mut *connection)
        .await?;
        if rows.is_empty() {
            return Ok(Vec::new());
        }
        let (named, orphaned): (Vec<_>, Vec<_>) = rows.into_iter().partition(|(_, named)| *named);
        // A digest with a new reference is no longer an orphan; it becomes one again with its last row.
        let named: Vec<String> = named.into_iter().map(|(digest, _)| digest).collect();
        forget(connection, &named).await?;
        if !orphaned.is_empty() {
            return Ok(orphaned.into_iter().map(|(digest, _)| digest).collect());
        }
    }
}

async fn forget(connection: &mut SqliteConnection, digests: &[String]) -> Result<(), CatalogueError> {
    for digest in digests {
        sqlx::query("DELETE FROM orphans WHERE digest = ?")
            .bind(digest)
            .execute(&mut *connection)
            .await?;
    }
    Ok(())
}
