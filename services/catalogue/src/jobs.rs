//! Jobs: one row each, however many frames.

use serde_json::json;
use sqlx::Row;
use sqlx::sqlite::{SqliteConnection, SqliteRow};

use crate::cursor;
use crate::error::CatalogueError;
use crate::types::{FailureRow, InsertJob, JobRow, JobState, NewJob, Page};

/// A failed attempt at a frame of a job.
pub(crate) struct Strike {
    pub(crate) job: String,
    pub(crate) failure: FailureRow,
}

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
        "SELECT id, dataset, spec, frames, done, failed, state, version, priority, created_ms, started_ms, finished_ms, digest
         FROM jobs WHERE id = ?",
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
    let rows = sqlx::query(
        "SELECT id, dataset, spec, frames, done, failed, state, version, priority, created_ms, started_ms, finished_ms, digest
         FROM jobs
         WHERE (?1 IS NULL OR dataset = ?1) AND (?2 IS NULL OR state = ?2) AND (?3 IS NULL OR id < ?3)
         ORDER BY id DESC LIMIT ?4",
    )
    .bind(&asked.dataset)
    .bind(&asked.state)
    .bind(before)
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
    if job.state == state {
        return Ok(job);
    }
    let allowed = match state {
        JobState::Cancelled | JobState::Paused => !job.state.has_ended(),
        JobState::Queued | JobState::Running => job.state == JobState::Paused,
        JobState::Done | JobState::DoneWithFailures => false,
    };
    if !allowed {
        let (from, to) = (job.state.to_string(), state.to_string());
        return Err(CatalogueError::Transition {
            id: id.to_owned(),
            from,
            to,
        });
    }
    sqlx::query("UPDATE jobs SET state = ?, version = version + 1 WHERE id = ?")
        .bind(state.to_string())
        .bind(id)
        .execute(&mut *connection)
        .await?;
    get(connection, id).await?.ok_or_else(not_found)
}

pub(crate) async fn strike(connection: &mut SqliteConnection, strike: &Strike) -> Result<(), CatalogueError> {
    let failure = &strike.failure;
    let given_up: Option<i64> =
        sqlx::query_scalar("SELECT quarantined FROM failures WHERE job_id = ? AND frame = ?")
            .bind(&strike.job)
            .bind(failure.frame as i64)
            .fetch_optional(&mut *connection)
            .await?;
    if given_up == Some(1) {
        return Ok(());
    }
    sqlx::query(
        "INSERT INTO failures (job_id, frame, strikes, quarantined, error) VALUES (?, ?, ?, ?, ?)
         ON CONFLICT (job_id, frame) DO UPDATE
         SET strikes = excluded.strikes, quarantined = excluded.quarantined, error = excluded.error",
    )
    .bind(&strike.job)
    .bind(failure.frame as i64)
    .bind(failure.strikes)
    .bind(failure.quarantined)
    .bind(&failure.error)
    .execute(&mut *connection)
    .await?;
    sqlx::query("UPDATE jobs SET failed = failed + ?, version = version + 1 WHERE id = ?")
        .bind(failure.quarantined)
        .bind(&strike.job)
        .execute(&mut *connection)
        .await?;
    advance(connection, &strike.job, None).await
}

/// Brings a job's state in line with its counters; a finished job gets its digest.
pub(crate) async fn advance(
    connection: &mut SqliteConnection,
    id: &str,
    now_ms: Option<u64>,
) -> Result<(), CatalogueError> {
    let Some(job) = get(connection, id).await? else {
        return Ok(());
    };
    if job.state.has_ended() || job.done + job.failed == 0 {
        return Ok(());
    }
    let ended = job.done + job.failed >= job.frames;
    let state = match (ended, job.failed, job.state) {
        (true, 0, _) => JobState::Done,
        (true, ..) => JobState::DoneWithFailures,
        (false, _, JobState::Paused) => JobState::Paused,
        _ => JobState::Running,
    };
    let digest = if ended && job.failed == 0 {
        let frames: Vec<String> =
            sqlx::query_scalar("SELECT digest FROM images WHERE job_id = ? ORDER BY frame")
                .bind(id)
                .fetch_all(&mut *connection)
                .await?;
        Some(spec::job_digest(frames.iter().map(String::as_str)))
    } else {
        None
    };
    sqlx::query(
        "UPDATE jobs SET state = ?1, digest = ?2, started_ms = coalesce(started_ms, ?3),
                         finished_ms = CASE WHEN ?4 THEN coalesce(?3, started_ms, created_ms) END
         WHERE id = ?5",
    )
    .bind(state.to_string())
    .bind(digest)
    .bind(now_ms.map(|ms| ms as i64))
    .bind(ended)
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
    })
}
