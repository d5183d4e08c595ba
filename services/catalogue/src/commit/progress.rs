//! How a job's counters and state follow from its images and failures.

use client::{FailureRow, JobState};
use futures::TryStreamExt;
use sqlx::sqlite::SqliteConnection;

use crate::error::CatalogueError;

/// Records a failed attempt, unless the frame was given up before or has its image by now.
pub(crate) async fn strike(
    connection: &mut SqliteConnection,
    job: &str,
    failure: &FailureRow,
) -> Result<(), CatalogueError> {
    let settled: Option<bool> = sqlx::query_scalar(
        "SELECT EXISTS (SELECT 1 FROM failures WHERE job_id = ?1 AND frame = ?2 AND quarantined = 1)
             OR EXISTS (SELECT 1 FROM images WHERE job_id = ?1 AND frame = ?2)
         FROM jobs WHERE id = ?1 AND id NOT IN (SELECT job_id FROM deletions)",
    )
    .bind(job)
    .bind(failure.frame as i64)
    .fetch_optional(&mut *connection)
    .await?;
    if settled != Some(false) {
        return Ok(());
    }
    sqlx::query(
        "INSERT INTO failures (job_id, frame, strikes, quarantined, error) VALUES (?, ?, ?, ?, ?)
         ON CONFLICT (job_id, frame) DO UPDATE
         SET strikes = excluded.strikes, quarantined = excluded.quarantined, error = excluded.error",
    )
    .bind(job)
    .bind(failure.frame as i64)
    .bind(failure.strikes)
    .bind(failure.quarantined)
    .bind(&failure.error)
    .execute(&mut *connection)
    .await?;
    let changed = sqlx::query_as(
        "UPDATE jobs SET failed = failed + ?2, version = version + 1,
                         state = CASE WHEN state = 'queued' AND ?2 THEN 'running' ELSE state END
         WHERE id = ?1
         RETURNING done + failed >= frames AND state IN ('queued', 'running', 'paused') AND unproven IS NULL, dataset, failed",
    )
    .bind(job)
    .bind(failure.quarantined)
    .fetch_one(&mut *connection)
    .await?;
    finish(connection, job, changed, None).await
}

/// New images of a job.
#[derive(Default)]
pub(crate) struct Added {
    pub(crate) dataset: String,
    pub(crate) images: i64,
    /// Of their frames, those that had counted as failed.
    pub(crate) given_up: i64,
    pub(crate) bytes: i64,
    /// Deliveries, which are unproven at first.
    pub(crate) deliveries: i64,
    pub(crate) first_ms: u64,
    pub(crate) last_ms: u64,
}

/// Counts new images of a job; a job that had ended without some of them gets its new final state.
pub(crate) async fn count_images(
    connection: &mut SqliteConnection,
    job: &str,
    added: &Added,
) -> Result<(), CatalogueError> {
    sqlx::query("UPDATE datasets SET images = images + ?, bytes = bytes + ? WHERE name = ?")
        .bind(added.images)
        .bind(added.bytes)
        .bind(&added.dataset)
        .execute(&mut *connection)
        .await?;
    let changed = sqlx::query_as(
        "UPDATE jobs SET done = done + ?2, failed = failed - ?3, bytes = bytes + ?4, version = version + ?2,
                         started_ms = coalesce(started_ms, ?5), unproven = nullif(coalesce(unproven, 0) + ?6, 0),
                         state = CASE WHEN state = 'queued' OR (state = 'done_with_failures' AND ?3 > 0)
                                      THEN 'running' ELSE state END
         WHERE id = ?1
         RETURNING done + failed >= frames AND state IN ('queued', 'running', 'paused') AND unproven IS NULL, dataset, failed",
    )
    .bind(job)
    .bind(added.images)
    .bind(added.given_up)
    .bind(added.bytes)
    .bind(added.first_ms as i64)
    .bind(added.deliveries)
    .fetch_one(&mut *connection)
    .await?;
    finish(connection, job, changed, Some(added.last_ms)).await
}

/// Ends a job whose frames have all ended, with the deliveries that are unproven.
pub(crate) async fn end(
    connection: &mut SqliteConnection,
    job: &str,
    now_ms: u64,
) -> Result<(), CatalogueError> {
    let changed =
        sqlx::query_as("UPDATE jobs SET version = version + 1 WHERE id = ? RETURNING 1, dataset, failed")
            .bind(job)
            .fetch_one(&mut *connection)
            .await?;
    finish(connection, job, changed, Some(now_ms)).await
}

/// Whether every frame of a job has ended and is proven, its dataset, its failed frames.
type Changed = (bool, String, i64);

/// Ends a job whose frames have all ended: one without failures gets its digest.
async fn finish(
    connection: &mut SqliteConnection,
    id: &str,
    (ended, dataset, failed): Changed,
    now_ms: Option<u64>,
) -> Result<(), CatalogueError> {
    if !ended {
        return Ok(());
    }
    let (state, digest) = if failed == 0 {
        // Read from the index alone: the job may have millions.
        let frames: Vec<String> =
            sqlx::query_scalar("SELECT digest FROM images WHERE dataset = ? AND job_id = ? ORDER BY frame")
                .bind(dataset)
                .bind(id)
                .fetch(&mut *connection)
                .try_collect()
                .await?;
        let digest = spec::job_digest(frames.iter().map(String::as_str));
        (JobState::Done, Some(digest))
    } else {
        (JobState::DoneWithFailures, None)
    };
    sqlx::query(
        "UPDATE jobs SET state = ?1, digest = ?2, finished_ms = coalesce(?3, started_ms, created_ms) WHERE id = ?4",
    )
    .bind(state.to_string())
    .bind(digest)
    .bind(now_ms.map(|ms| ms as i64))
    .bind(id)
    .execute(connection)
    .await?;
    Ok(())
}
