//! Proofs of frames from workers that the service did not start.
//!
//! A delivery is proven if its frame was rendered again with the same result, or a later delivery of its worker in the job
//! was. A job with unproven deliveries stays open after its last frame until [`Catalogue::settle`] ends it.

use client::JobRow;
use sqlx::sqlite::SqliteConnection;

use super::rows::{imported, known_job, row};
use crate::catalogue::Catalogue;
use crate::commit::progress;
use crate::digests::tables::job_columns;
use crate::error::CatalogueError;
use crate::types::{DueCheck, Settled};

/// Rows that one transaction forgets.
const FORGOTTEN_ROWS: u32 = 1000;

impl Catalogue {
    /// The key of the draw of checked frames.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn check_key(&self) -> Result<String, CatalogueError> {
        let key = sqlx::query_scalar("SELECT key FROM check_key LIMIT 1");
        let key: Option<String> = key.fetch_optional(&mut *self.reader().await?).await?;
        key.ok_or_else(|| CatalogueError::damaged("the key of checks".to_owned()))
    }

    /// All frames to be rendered again, in the order of jobs and frames.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn due_checks(&self) -> Result<Vec<DueCheck>, CatalogueError> {
        let sql = "SELECT job_id, frame, worker FROM deliveries WHERE due = 1 ORDER BY job_id, frame";
        let rows: Vec<DueRow> = sqlx::query_as(sql).fetch_all(&mut *self.reader().await?).await?;
        Ok(rows.into_iter().map(due_check).collect())
    }

    /// The frame of a check was rendered again with the same result. This also proves the earlier deliveries of its worker
    /// in the job.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn record_good_check(&self, check: DueCheck) -> Result<(), CatalogueError> {
        self.write(move |c| Box::pin(async move { record_good(c, &check).await }))
            .await
    }

    /// The frame of a check could not be rendered again. It stays unproven unless a later check covers it.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn record_open_check(&self, check: DueCheck) -> Result<(), CatalogueError> {
        self.write(move |c| {
            Box::pin(async move {
                let sql = "UPDATE deliveries SET due = 0 WHERE job_id = ? AND frame = ? AND worker = ?";
                let statement = sqlx::query(sql).bind(check.job).bind(check.frame as i64);
                statement.bind(check.worker).execute(c).await?;
                Ok(())
            })
        })
        .await
    }

    /// Ends a job whose frames have all ended. If deliveries are unproven, it draws a frame of each of their workers to be
    /// checked instead, unless `gives_up`: then the job ends with unproven frames. No effect on other jobs.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn settle(&self, job: &str, gives_up: bool, now_ms: u64) -> Result<Settled, CatalogueError> {
        let job = job.to_owned();
        self.write(move |c| Box::pin(async move { settle(c, &job, gives_up, now_ms).await }))
            .await
    }

    /// Frames of a worker that were not rendered again themselves, job by job.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn unchecked_frames(&self, worker: &str) -> Result<Vec<(String, u64)>, CatalogueError> {
        let sql =
            "SELECT job_id, frame FROM deliveries WHERE worker = ? AND proof < 2 ORDER BY job_id, frame";
        let rows: Vec<(String, i64)> = sqlx::query_as(sql)
            .bind(worker)
            .fetch_all(&mut *self.reader().await?)
            .await?;
        let frames = rows.into_iter().map(|(job, frame)| (job, frame as u64));
        Ok(frames.collect())
    }

    /// Has every delivery of an open job checked, now and later, because one of them was wrong. Returns the new checks.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn distrust(&self, job: &str) -> Result<Vec<DueCheck>, CatalogueError> {
        let job = job.to_owned();
        self.write(move |c| Box::pin(async move { distrust(c, &job).await }))
            .await
    }

    /// Sets whether workers of any version and kind of machine may render the frames of a job.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`]; [`CatalogueError::Imported`]; [`CatalogueError::Transition`] for an ended job.
    pub async fn mix_machines(&self, job: &str, mixed: bool) -> Result<JobRow, CatalogueError> {
        let job = job.to_owned();
        self.write(move |c| Box::pin(async move { mix_machines(c, &job, mixed).await }))
            .await
    }

    /// Forgets some deliveries of an ended job without unproven frames and due checks. Returns whether more may remain.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn forget_deliveries(&self, job: &str) -> Result<bool, CatalogueError> {
        let job = job.to_owned();
        self.write(move |c| Box::pin(async move { forget(c, &job).await }))
            .await
    }
}

/// A row of a due check: job, frame, worker.
type DueRow = (String, i64, String);

fn due_check((job, frame, worker): DueRow) -> DueCheck {
    DueCheck {
        job,
        frame: frame as u64,
        worker,
    }
}

async fn record_good(connection: &mut SqliteConnection, check: &DueCheck) -> Result<(), CatalogueError> {
    let DueCheck { job, frame, worker } = check;
    let checked: Option<(i64, i64)> = sqlx::query_as(
        "SELECT covers, proof FROM deliveries WHERE job_id = ? AND frame = ? AND worker = ? AND due = 1",
    )
    .bind(job)
    .bind(*frame as i64)
    .bind(worker)
    .fetch_optional(&mut *connection)
    .await?;
    // A frame that lost its image meanwhile is a new delivery.
    let Some((covers, proof)) = checked else {
        return Ok(());
    };
    sqlx::query("UPDATE deliveries SET proof = 2, due = 0 WHERE job_id = ? AND frame = ?")
        .bind(job)
        .bind(*frame as i64)
        .execute(&mut *connection)
        .await?;
    // Drawn frames wait for their own checks.
    let earlier = sqlx::query(
        "UPDATE deliveries SET proof = 1 WHERE job_id = ? AND worker = ? AND proof = 0 AND due = 0 AND place <= ?",
    )
    .bind(job)
    .bind(worker)
    .bind(covers)
    .execute(&mut *connection)
    .await?;
    let proven = earlier.rows_affected() as i64 + i64::from(proof == 0);
    sqlx::query(
        "UPDATE jobs SET unproven = nullif(coalesce(unproven, 0) - ?2, 0), version = version + 1 WHERE id = ?1 AND ?2 > 0",
    )
    .bind(job)
    .bind(proven)
    .execute(connection)
    .await?;
    Ok(())
}

async fn settle(
    connection: &mut SqliteConnection,
    job: &str,
    gives_up: bool,
    now_ms: u64,
) -> Result<Settled, CatalogueError> {
    let open: Option<(i64, bool)> = sqlx::query_as(
        "SELECT coalesce(unproven, 0), coalesce(distrusted, 0) FROM jobs
         WHERE id = ? AND done + failed >= frames AND state IN ('queued', 'running', 'paused') AND set_location IS NULL
           AND id NOT IN (SELECT job_id FROM deletions)",
    )
    .bind(job)
    .fetch_optional(&mut *connection)
    .await?;
    let Some((unproven, is_distrusted)) = open else {
        // A job can also end with its last image or failure, or by a cancel.
        let has_ended = "SELECT EXISTS (SELECT 1 FROM jobs WHERE id = ? AND state NOT IN ('queued', 'running', 'paused'))";
        let has_ended: bool = sqlx::query_scalar(has_ended)
            .bind(job)
            .fetch_one(&mut *connection)
            .await?;
        return Ok(Settled {
            checks: Vec::new(),
            has_ended,
        });
    };
    if unproven > 0 && !gives_up {
        let is_waiting = "SELECT EXISTS (SELECT 1 FROM deliveries WHERE job_id = ? AND due = 1)";
        let is_waiting: bool = sqlx::query_scalar(is_waiting)
            .bind(job)
            .fetch_one(&mut *connection)
            .await?;
        let checks = match is_waiting {
            true => Vec::new(),
            false if is_distrusted => draw_all(connection, job).await?,
            false => draw_last(connection, job).await?,
        };
        return Ok(Settled {
            checks,
            has_ended: false,
        });
    }
    sqlx::query("UPDATE deliveries SET due = 0 WHERE job_id = ? AND due = 1")
        .bind(job)
        .execute(&mut *connection)
        .await?;
    progress::end(connection, job, now_ms).await?;
    Ok(Settled {
        checks: Vec::new(),
        has_ended: true,
    })
}

/// Draws a frame of each worker with unproven deliveries, after the last of them, so that no worker can foresee it.
async fn draw_last(connection: &mut SqliteConnection, job: &str) -> Result<Vec<DueCheck>, CatalogueError> {
    let sql = "SELECT max(place), worker FROM deliveries WHERE job_id = ? AND proof = 0 GROUP BY worker";
    let workers: Vec<(i64, String)> = sqlx::query_as(sql).bind(job).fetch_all(&mut *connection).await?;
    let mut checks = Vec::with_capacity(workers.len());
    for (last, worker) in workers {
        let drawn: DueRow = sqlx::query_as(
            "UPDATE deliveries SET due = 1, covers = ?3
             WHERE job_id = ?1 AND frame = (SELECT frame FROM deliveries WHERE job_id = ?1 AND worker = ?2 AND proof = 0
                                            ORDER BY random() LIMIT 1)
             RETURNING job_id, frame, worker",
        )
        .bind(job)
        .bind(worker)
        .bind(last)
        .fetch_one(&mut *connection)
        .await?;
        checks.push(due_check(drawn));
    }
    Ok(checks)
}

async fn distrust(connection: &mut SqliteConnection, job: &str) -> Result<Vec<DueCheck>, CatalogueError> {
    let changed = sqlx::query(
        "UPDATE jobs SET distrusted = 1, version = version + 1
         WHERE id = ? AND state IN ('queued', 'running', 'paused') AND id NOT IN (SELECT job_id FROM deletions)",
    )
    .bind(job)
    .execute(&mut *connection)
    .await?;
    if changed.rows_affected() == 0 {
        return Ok(Vec::new());
    }
    // Only a check of its own proves a frame now.
    sqlx::query("UPDATE deliveries SET proof = 0, covers = 0 WHERE job_id = ? AND proof < 2")
        .bind(job)
        .execute(&mut *connection)
        .await?;
    count_unproven(connection, job).await?;
    draw_all(connection, job).await
}

/// Draws every unproven delivery of a job.
async fn draw_all(connection: &mut SqliteConnection, job: &str) -> Result<Vec<DueCheck>, CatalogueError> {
    let drawn: Vec<DueRow> = sqlx::query_as(
        "UPDATE deliveries SET due = 1 WHERE job_id = ? AND proof = 0 AND due = 0 RETURNING job_id, frame, worker",
    )
    .bind(job)
    .fetch_all(connection)
    .await?;
    Ok(drawn.into_iter().map(due_check).collect())
}

/// Counts the unproven deliveries of a job again.
pub(crate) async fn count_unproven(
    connection: &mut SqliteConnection,
    job: &str,
) -> Result<(), CatalogueError> {
    sqlx::query(
        "UPDATE jobs SET unproven = nullif((SELECT count(*) FROM deliveries WHERE job_id = ?1 AND proof = 0), 0) WHERE id = ?1",
    )
    .bind(job)
    .execute(connection)
    .await?;
    Ok(())
}

async fn mix_machines(
    connection: &mut SqliteConnection,
    id: &str,
    mixed: bool,
) -> Result<JobRow, CatalogueError> {
    let job = known_job(connection, id).await?;
    if job.set.is_some() {
        return Err(imported(job));
    }
    if job.state.has_ended() {
        return Err(CatalogueError::Transition {
            id: job.id,
            from: job.state.to_string(),
            to: "finished on other machines".to_owned(),
        });
    }
    let changed = sqlx::query(concat!(
        "UPDATE jobs SET mixed = nullif(?, 0), version = version + 1 WHERE id = ? RETURNING ",
        job_columns!()
    ));
    row(&changed.bind(mixed).bind(id).fetch_one(connection).await?)
}

async fn forget(connection: &mut SqliteConnection, job: &str) -> Result<bool, CatalogueError> {
    let gone = sqlx::query(
        "DELETE FROM deliveries
         WHERE job_id = ?1
           AND frame IN (SELECT frame FROM deliveries WHERE job_id = ?1 LIMIT ?2)
           AND NOT EXISTS (SELECT 1 FROM deliveries WHERE job_id = ?1 AND due = 1)
           AND EXISTS (SELECT 1 FROM jobs WHERE id = ?1 AND unproven IS NULL
                                            AND state NOT IN ('queued', 'running', 'paused'))",
    )
    .bind(job)
    .bind(FORGOTTEN_ROWS)
    .execute(connection)
    .await?;
    Ok(gone.rows_affected() == u64::from(FORGOTTEN_ROWS))
}
