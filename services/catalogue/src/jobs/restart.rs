//! Starting a job again, in transactions of bounded size.
//!
//! The first transaction marks the job and forgets its failures. The others remove its images and then the mark. A marked job is
//! not open to workers, so after a kill at any point the next start of the service continues here.

use client::{JobRow, JobState};
use sqlx::sqlite::SqliteConnection;

use super::reopen::reopen;
use super::rows::{cannot_become, imported, known_job, row};
use crate::catalogue::Catalogue;
use crate::datasets::versions::refuse_sealed;
use crate::digests::tables::job_columns;
use crate::error::CatalogueError;

/// Images that one transaction removes: some 20 ms of the writer's time.
const REMOVED_IMAGES: u32 = 1000;

impl Catalogue {
    /// Marks a job that starts again from the beginning, by one kind of machine. The caller withdraws it from workers and calls
    /// [`Catalogue::continue_restart`].
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`]; [`CatalogueError::Imported`]; [`CatalogueError::Sealed`]; [`CatalogueError::Transition`] for
    /// a cancelled job.
    pub async fn begin_restart(&self, id: &str) -> Result<(), CatalogueError> {
        let id = id.to_owned();
        self.write(move |c| Box::pin(async move { begin(c, &id).await }))
            .await
    }

    /// Removes some images of a marked job. Returns its row once none remain: then the mark is gone, and the caller offers its
    /// frames to workers. A job cancelled meanwhile keeps its remaining images.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`] for a deleted job.
    pub async fn continue_restart(&self, id: &str) -> Result<Option<JobRow>, CatalogueError> {
        let id = id.to_owned();
        self.write(move |c| Box::pin(async move { continue_one(c, &id).await }))
            .await
    }

    /// Ids of the marked jobs.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn restarting_jobs(&self) -> Result<Vec<String>, CatalogueError> {
        let ids = sqlx::query_scalar(
            "SELECT id FROM jobs WHERE restarting = 1 AND id NOT IN (SELECT job_id FROM deletions) ORDER BY id",
        );
        Ok(ids.fetch_all(&mut *self.reader().await?).await?)
    }
}

async fn begin(connection: &mut SqliteConnection, id: &str) -> Result<(), CatalogueError> {
    let job = known_job(connection, id).await?;
    if job.set.is_some() {
        return Err(imported(job));
    }
    if job.state == JobState::Cancelled {
        return Err(cannot_become(&job, "started again; submit it again"));
    }
    refuse_sealed(connection, id).await?;
    sqlx::query("DELETE FROM failures WHERE job_id = ?")
        .bind(id)
        .execute(&mut *connection)
        .await?;
    sqlx::query(
        "UPDATE jobs SET restarting = 1, failed = 0, mixed = NULL, digest = NULL, finished_ms = NULL, version = version + 1,
                         state = CASE WHEN state = 'paused' THEN 'paused' WHEN done > 0 THEN 'running' ELSE 'queued' END
         WHERE id = ?",
    )
    .bind(id)
    .execute(connection)
    .await?;
    Ok(())
}

async fn continue_one(connection: &mut SqliteConnection, id: &str) -> Result<Option<JobRow>, CatalogueError> {
    let job = known_job(connection, id).await?;
    if job.state != JobState::Cancelled {
        let frames: Vec<i64> =
            sqlx::query_scalar("SELECT frame FROM images WHERE job_id = ? ORDER BY frame LIMIT ?")
                .bind(id)
                .bind(REMOVED_IMAGES)
                .fetch_all(&mut *connection)
                .await?;
        if !frames.is_empty() {
            let frames: Vec<u64> = frames.into_iter().map(|frame| frame as u64).collect();
            return reopen(connection, id, &frames).await.map(|_| None);
        }
    }
    let ended = sqlx::query(concat!(
        "UPDATE jobs SET restarting = NULL, version = version + 1,
                         state = CASE WHEN state = 'running' THEN 'queued' ELSE state END
         WHERE id = ? RETURNING ",
        job_columns!()
    ));
    Ok(Some(row(&ended.bind(id).fetch_one(connection).await?)?))
}
