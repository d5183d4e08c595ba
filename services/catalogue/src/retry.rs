//! Trying the failed frames of a job again.

use sqlx::sqlite::SqliteConnection;

use crate::catalogue::Catalogue;
use crate::error::CatalogueError;
use crate::jobs;
use crate::types::{JobState, Retried};

impl Catalogue {
    /// Forgets the failures of the frames that were given up, and opens the job again if it had ended with them. The
    /// caller offers the frames to workers.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`]; [`CatalogueError::Transition`] for a job that was cancelled or is done.
    pub async fn retry_failed(&self, id: &str) -> Result<Retried, CatalogueError> {
        let id = id.to_owned();
        self.write(move |c| Box::pin(async move { retry_failed(c, &id).await }))
            .await
    }
}

async fn retry_failed(connection: &mut SqliteConnection, id: &str) -> Result<Retried, CatalogueError> {
    let not_found = || CatalogueError::NotFound {
        what: "job",
        name: id.to_owned(),
    };
    let job = jobs::get(connection, id).await?.ok_or_else(not_found)?;
    if matches!(job.state, JobState::Cancelled | JobState::Done) {
        return Err(jobs::cannot_become(&job, "tried again"));
    }
    let mut frames: Vec<i64> =
        sqlx::query_scalar("DELETE FROM failures WHERE job_id = ? AND quarantined = 1 RETURNING frame")
            .bind(id)
            .fetch_all(&mut *connection)
            .await?;
    frames.sort_unstable();
    sqlx::query(
        "UPDATE jobs SET failed = failed - ?2, version = version + 1, digest = NULL, finished_ms = NULL,
                         state = CASE WHEN state = 'paused' THEN 'paused'
                                      WHEN done > 0 THEN 'running' ELSE 'queued' END
         WHERE id = ?1",
    )
    .bind(id)
    .bind(frames.len() as i64)
    .execute(&mut *connection)
    .await?;
    Ok(Retried {
        job: jobs::get(connection, id).await?.ok_or_else(not_found)?,
        frames: frames.into_iter().map(|frame| frame as u64).collect(),
    })
}
