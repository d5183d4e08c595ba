//! Jobs: one row each, however many frames.

use futures::TryStreamExt;
use serde_json::json;
use sqlx::sqlite::{SqliteConnection, SqliteRow};
use sqlx::{AssertSqlSafe, Row};

use crate::cursor;
use crate::error::CatalogueError;
use crate::types::{FailureRow, InsertJob, JobRow, JobState, NewJob, Page};

/// Which jobs.
pub(crate) struct Asked {
    pub(crate) dataset: Option<String>,
    pub(crate) state: Option<String>,
    pub(crate) limit: u32,
    pub(crate) cursor: Option<String>,
}

pub(crate) async fn insert(
    connection: &mut SqliteConnection,
    job: &NewJob,
) -> Result<InsertJob, CatalogueError> {
    if let Some(key) = &job.idempotency {
        let known =
            sqlx::query("SELECT body_digest, job_id FROM idempotency_keys WHERE owner = ? AND key = ?")
                .bind(&key.owner)
                .bind(&key.key)
                .fetch_optional(&mut *connection)
                .await?;
        if let Some(known) = known {
            let same = known.try_get::<String, _>(0)? == key.body_digest;
            return Ok(if same {
                InsertJob::Replayed {
                    job_id: known.try_get(1)?,
                }
            } else {
                InsertJob::KeyConflict
            });
        }
    }
    sqlx::query(
        "INSERT INTO jobs (id, dataset, spec, spec_digest, frames, priority, state, created_ms)
         VALUES (?, ?, ?, ?, ?, ?, 'queued', ?)",
    )
    .bind(&job.id)
    .bind(&job.dataset)
    .bind(&job.spec)
    .bind(&job.spec_digest)
    .bind(job.frames as i64)
    .bind(job.priority)
    .bind(job.created_ms as i64)
    .execute(&mut *connection)
    .await?;
    sqlx::query(
        "INSERT INTO datasets (name, jobs) VALUES (?, 1) ON CONFLICT (name) DO UPDATE SET jobs = jobs + 1",
    )
    .bind(&job.dataset)
    .execute(&mut *connection)
    .await?;
    if let Some(key) = &job.idempotency {
        sqlx::query("INSERT INTO idempotency_keys (owner, key, body_digest, job_id) VALUES (?, ?, ?, ?)")
            .bind(&key.owner)
            .bind(&key.key)
            .bind(&key.body_digest)
            .bind(&job.id)
            .execute(&mut *connection)
            .await?;
    }
    Ok(InsertJob::Created)
}

pub(crate) async fn get(
    connection: &mut SqliteConnection,
    id: &str,
) -> Result<Option<JobRow>, CatalogueError> {
    let found = sqlx::query(
        "SELECT id, dataset, spec, frames, done, failed, state, version, priority, created_ms, started_ms, finished_ms, digest,
                bytes
         FROM jobs WHERE id = ?1 AND id NOT IN (SELECT job_id FROM deletions)",
    )
    .bind(id)
    .fetch_optional(connection)
    .await?;
    found.as_ref().map(row).transpose()
}

pub(crate) async fn list(
    connection: &mut SqliteConnection,
    asked: &Asked,
) -> Result<Page<JobRow>, CatalogueError> {
    let question = cursor::question(&[Some("jobs"), asked.dataset.as_deref(), asked.state.as_deref()]);
    let before = match &asked.cursor {
        Some(text) => Some(
            cursor::read(&question, text)?
                .as_str()
                .ok_or(CatalogueError::Cursor)?
                .to_owned(),
        ),
        None => None,
    };
    // Each condition only where it is asked for: an `OR` around it would keep the index from being used.
    let mut sql =
        "SELECT id, dataset, spec, frames, done, failed, state, version, priority, created_ms, started_ms,
                          finished_ms, digest, bytes
                   FROM jobs WHERE id NOT IN (SELECT job_id FROM deletions)"
            .to_owned();
    let conditions = [
        (&asked.dataset, " AND dataset = ?"),
        (&asked.state, " AND state = ?"),
        (&before, " AND id < ?"),
    ];
    for (value, condition) in &conditions {
        sql.push_str(if value.is_some() { condition } else { "" });
    }
    sql.push_str(" ORDER BY id DESC LIMIT ?");
    let mut statement = sqlx::query(AssertSqlSafe(sql));
    for (value, _) in conditions {
        if let Some(value) = value {
            statement = statement.bind(value.clone());
        }
    }
    let rows = statement
        .bind(i64::from(asked.limit) + 1)
        .fetch_all(connection)
        .await?;
    let mut items = rows.iter().map(row).collect::<Result<Vec<_>, _>>()?;
    let more = items.len() > asked.limit as usize;
    items.truncate(asked.limit as usize);
    let last = items
        .last()
        .filter(|_| more)
        .map(|job| cursor::write(&question, &json!(job.id)));
    Ok(Page {
        items,
        next_cursor: last,
    })
}

pub(crate) async fn set_state(
    connection: &mut SqliteConnection,
    id: &str,
    state: JobState,
) -> Result<JobRow, CatalogueError> {
    let not_found = || CatalogueError::NotFound {
        what: "job",
        name: id.to_owned(),
    };
    let job = get(connection, id).await?.ok_or_else(not_found)?;
    let (state, allowed) = match (job.state, state) {
        (from, to) if from == to => return Ok(job),
        (JobState::Queued | JobState::Running, JobState::Queued | JobState::Running) => return Ok(job),
        (from, JobState::Cancelled | JobState::Paused) => (state, !from.has_ended()),
        // A job goes on as what it is: its frames say whether it has begun.
        (from, JobState::Queued | JobState::Running) => (going(&job), from == JobState::Paused),
        (_, JobState::Done | JobState::DoneWithFailures) => (state, false),
    };
    if !allowed {
        return Err(cannot_become(&job, &state.to_string()));
    }
    sqlx::query("UPDATE jobs SET state = ?, version = version + 1 WHERE id = ?")
        .bind(state.to_string())
        .bind(id)
        .execute(&mut *connection)
        .await?;
    get(connection, id).await?.ok_or_else(not_found)
}

/// What a job is that is neither paused nor at its end.
pub(crate) fn going(job: &JobRow) -> JobState {
    if job.done + job.failed > 0 {
        JobState::Running
    } else {
        JobState::Queued
    }
}

pub(crate) fn cannot_become(job: &JobRow, to: &str) -> CatalogueError {
    CatalogueError::Transition {
        id: job.id.clone(),
        from: job.state.to_string(),
        to: to.to_owned(),
    }
}

/// Writes a failed attempt down, unless the frame was given up before or has its image by now.
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
    let ended: bool = sqlx::query_scalar(
        "UPDATE jobs SET failed = failed + ?2, version = version + 1,
                         state = CASE WHEN state = 'queued' AND ?2 THEN 'running' ELSE state END
         WHERE id = ?1
         RETURNING done + failed >= frames AND state IN ('queued', 'running', 'paused')",
    )
    .bind(job)
    .bind(failure.quarantined)
    .fetch_one(&mut *connection)
    .await?;
    if ended {
        finish(connection, job, None).await?;
    }
    Ok(())
}

/// New images of a job.
#[derive(Default)]
pub(crate) struct Added {
    pub(crate) dataset: String,
    pub(crate) images: i64,
    /// Of their frames, those that had counted as failed.
    pub(crate) given_up: i64,
    pub(crate) bytes: i64,
    pub(crate) first_ms: u64,
    pub(crate) last_ms: u64,
}

/// Counts new images of a job.
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
    let ended: bool = sqlx::query_scalar(
        "UPDATE jobs SET done = done + ?2, failed = failed - ?3, bytes = bytes + ?4, version = version + ?2,
                         started_ms = coalesce(started_ms, ?5),
                         state = CASE state WHEN 'queued' THEN 'running' ELSE state END
         WHERE id = ?1
         RETURNING done + failed >= frames AND state IN ('queued', 'running', 'paused')",
    )
    .bind(job)
    .bind(added.images)
    .bind(added.given_up)
    .bind(added.bytes)
    .bind(added.first_ms as i64)
    .fetch_one(&mut *connection)
    .await?;
    if ended {
        finish(connection, job, Some(added.last_ms)).await?;
    }
    Ok(())
}

/// Every frame of the job has ended: a job without failures gets its digest.
async fn finish(
    connection: &mut SqliteConnection,
    id: &str,
    now_ms: Option<u64>,
) -> Result<(), CatalogueError> {
    let (dataset, failed): (String, i64) = sqlx::query_as("SELECT dataset, failed FROM jobs WHERE id = ?")
        .bind(id)
        .fetch_one(&mut *connection)
        .await?;
    let (state, digest) = if failed == 0 {
        // Answered by the index alone: the job may have millions.
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

pub(crate) fn row(row: &SqliteRow) -> Result<JobRow, CatalogueError> {
    let number = |at: usize| row.try_get::<i64, _>(at).map(|n| n as u64);
    let time = |at: usize| row.try_get::<Option<i64>, _>(at).map(|n| n.map(|n| n as u64));
    let state: String = row.try_get(6)?;
    Ok(JobRow {
        id: row.try_get(0)?,
        dataset: row.try_get(1)?,
        spec: row.try_get(2)?,
        frames: number(3)?,
        done: number(4)?,
        failed: number(5)?,
        state: state
            .parse()
            .map_err(|message| CatalogueError::Failed { message })?,
        version: number(7)?,
        priority: row.try_get(8)?,
        created_ms: number(9)?,
        started_ms: time(10)?,
        finished_ms: time(11)?,
        digest: row.try_get(12)?,
        bytes: number(13)?,
    })
}
