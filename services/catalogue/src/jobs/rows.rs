//! Jobs, one row each.

use client::{JobRow, JobState, Page, Price};
use sqlx::AssertSqlSafe;
use sqlx::sqlite::{SqliteConnection, SqliteRow};

use crate::catalogue::{Catalogue, within};
use crate::damage::DamageLog;
use crate::datasets::versions::refuse_sealed;
use crate::digests::row_digests::{Side, intact};
use crate::digests::tables::{JOBS, digested_job_columns, job_columns};
use crate::error::CatalogueError;
use crate::query::cells::Cells;
use crate::query::cursor;
use crate::query::list_page::list_page;
use crate::query::scope::Scope;
use crate::types::Retried;

impl Catalogue {
    /// Changes the state of a job and returns its row. Cancelling an ended job has no effect.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`], [`CatalogueError::Transition`].
    pub async fn set_state(&self, id: &str, state: JobState) -> Result<JobRow, CatalogueError> {
        let id = id.to_owned();
        self.write(move |c| Box::pin(async move { set_state(c, &id, state, false).await }))
            .await
    }

    /// Changes the state of a shared job to that of its set.
    ///
    /// # Errors
    /// As [`Catalogue::set_state`].
    pub async fn set_shared_state(&self, id: &str, state: JobState) -> Result<JobRow, CatalogueError> {
        let id = id.to_owned();
        self.write(move |c| Box::pin(async move { set_state(c, &id, state, true).await }))
            .await
    }

    /// Deletes the failures of abandoned frames, and opens the job again if it had ended with them. The caller offers the frames to
    /// workers.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`]; [`CatalogueError::Transition`] for a cancelled or completed job.
    pub async fn retry_failed(&self, id: &str) -> Result<Retried, CatalogueError> {
        let id = id.to_owned();
        self.write(move |c| Box::pin(async move { retry_failed(c, &id, false).await }))
            .await
    }

    /// Does the same for a shared job whose set renders the failed frames again.
    ///
    /// # Errors
    /// As [`Catalogue::retry_failed`].
    pub async fn retry_shared(&self, id: &str) -> Result<JobRow, CatalogueError> {
        let id = id.to_owned();
        let again = self.write(move |c| Box::pin(async move { retry_failed(c, &id, true).await }));
        Ok(again.await?.job)
    }

    /// A job.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn job(&self, id: &str) -> Result<Option<JobRow>, CatalogueError> {
        get(&mut *self.reader().await?, id, Side::Reader).await
    }

    /// The canonical description of a job.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn description(&self, id: &str) -> Result<Option<String>, CatalogueError> {
        let found: Option<(String, String)> = sqlx::query_as(
            "SELECT spec, spec_digest FROM jobs WHERE id = ? AND id NOT IN (SELECT job_id FROM deletions)",
        )
        .bind(id)
        .fetch_optional(&mut *self.reader().await?)
        .await?;
        found
            .map(|(spec, digest): (String, String)| intact(id, &spec, &digest).map(str::to_owned))
            .transpose()
    }

    /// Jobs, newest first.
    ///
    /// # Errors
    /// [`CatalogueError::Cursor`]; [`CatalogueError::Filter`] for a state that does not exist.
    pub async fn jobs(
        &self,
        dataset: Option<String>,
        state: Option<String>,
        limit: u32,
        cursor: Option<String>,
    ) -> Result<Page<JobRow>, CatalogueError> {
        if let Some(Err(message)) = state.as_deref().map(str::parse::<JobState>) {
            return Err(CatalogueError::refused(message));
        }
        let list = JobList {
            dataset,
            state,
            limit,
            cursor,
        };
        within(list.read(&mut *self.reader().await?, &self.damage)).await
    }

    /// The jobs of imported sets, newest first. Damaged ones are reported and left out.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn imported_jobs(&self) -> Result<Vec<JobRow>, CatalogueError> {
        let rows = sqlx::query(concat!(
            "SELECT ",
            digested_job_columns!(),
            " FROM jobs WHERE set_location IS NOT NULL AND id NOT IN (SELECT job_id FROM deletions) ORDER BY id DESC",
        ));
        let rows = rows.fetch_all(&mut *self.reader().await?).await?;
        rows.iter()
            .filter_map(|row| self.unless_damaged(verified(row, Side::Reader)))
            .collect()
    }

    /// The job of an imported set.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn job_of_set(&self, set: &str) -> Result<Option<JobRow>, CatalogueError> {
        of_set(&mut *self.reader().await?, set, Side::Reader).await
    }
}

pub(crate) async fn get(
    connection: &mut SqliteConnection,
    id: &str,
    side: Side,
) -> Result<Option<JobRow>, CatalogueError> {
    let found = sqlx::query(concat!(
        "SELECT ",
        digested_job_columns!(),
        " FROM jobs WHERE id = ?1 AND id NOT IN (SELECT job_id FROM deletions)",
    ))
    .bind(id)
    .fetch_optional(connection)
    .await?;
    found.as_ref().map(|row| verified(row, side)).transpose()
}

pub(super) async fn of_set(
    connection: &mut SqliteConnection,
    set: &str,
    side: Side,
) -> Result<Option<JobRow>, CatalogueError> {
    let found = sqlx::query(concat!(
        "SELECT ",
        digested_job_columns!(),
        " FROM jobs WHERE set_location = ? AND id NOT IN (SELECT job_id FROM deletions)",
    ))
    .bind(set)
    .fetch_optional(connection)
    .await?;
    found.as_ref().map(|row| verified(row, side)).transpose()
}

pub(super) async fn known_job(connection: &mut SqliteConnection, id: &str) -> Result<JobRow, CatalogueError> {
    get(connection, id, Side::Writer)
        .await?
        .ok_or_else(|| CatalogueError::not_found("job", id))
}

/// A page of jobs.
struct JobList {
    dataset: Option<String>,
    state: Option<String>,
    limit: u32,
    cursor: Option<String>,
}

impl JobList {
    async fn read(
        self,
        connection: &mut SqliteConnection,
        damage: &DamageLog,
    ) -> Result<Page<JobRow>, CatalogueError> {
        let Self {
            dataset,
            state,
            limit,
            cursor,
        } = self;
        let identity = cursor::query_identity(&[Some("jobs"), dataset.as_deref(), state.as_deref()]);
        let before = cursor::read_id(&identity, cursor.as_deref())?;
        // Conditions are left out if unused: an `OR` would prevent the use of the index.
        let mut sql = concat!(
            "SELECT ",
            digested_job_columns!(),
            " FROM jobs WHERE id NOT IN (SELECT job_id FROM deletions)"
        )
        .to_owned();
        let scope = dataset.as_deref().map(Scope::parse);
        let version = scope.and_then(|scope| scope.version);
        let conditions = [
            (scope.map(|scope| scope.dataset), " AND dataset = ?"),
            (state.as_deref(), " AND state = ?"),
            (before.as_deref(), " AND id < ?"),
        ];
        for (value, condition) in &conditions {
            sql.push_str(if value.is_some() { condition } else { "" });
        }
        if version.is_some() {
            sql.push_str(
                " AND id IN (SELECT job_id FROM version_jobs v WHERE v.dataset = jobs.dataset AND version = ?)",
            );
        }
        sql.push_str(" ORDER BY id DESC LIMIT ?");
        let mut statement = sqlx::query(AssertSqlSafe(sql));
        for value in conditions.into_iter().filter_map(|(value, _)| value) {
            statement = statement.bind(value);
        }
        if let Some(version) = version {
            statement = statement.bind(version as i64);
        }
        let rows = statement.bind(i64::from(limit) + 1).fetch_all(connection).await?;
        list_page(&identity, &rows, limit, damage, |row| verified(row, Side::Reader))
    }
}

async fn set_state(
    connection: &mut SqliteConnection,
    id: &str,
    state: JobState,
    shared: bool,
) -> Result<JobRow, CatalogueError> {
    use JobState::{Cancelled, Done, DoneWithFailures, Paused, Queued, Running};
    let job = known_job(connection, id).await?;
    let (state, allowed) = match (job.state, state) {
        (from, to) if from == to => return Ok(job),
        (Queued | Running, Queued | Running) => return Ok(job),
        (from, Cancelled) if from.has_ended() => return Ok(job),
        _ if job.set.is_some() && !shared => return Err(imported(job)),
        (from, Cancelled | Paused) => (state, !from.has_ended()),
        // A resumed job is running if any of its frames has ended.
        (from, Queued | Running) if job.done + job.failed > 0 => (Running, from == Paused),
        (from, Queued | Running) => (Queued, from == Paused),
        (_, Done | DoneWithFailures) => (state, false),
    };
    if !allowed {
        return Err(cannot_become(&job, &state.to_string()));
    }
    let changed = sqlx::query(concat!(
        "UPDATE jobs SET state = ?, version = version + 1 WHERE id = ? RETURNING ",
        job_columns!()
    ));
    row(&changed
        .bind(state.to_string())
        .bind(id)
        .fetch_one(connection)
        .await?)
}

async fn retry_failed(
    connection: &mut SqliteConnection,
    id: &str,
    shared: bool,
) -> Result<Retried, CatalogueError> {
    let job = known_job(connection, id).await?;
    if job.set.is_some() && !shared {
        return Err(imported(job));
    }
    if matches!(job.state, JobState::Cancelled | JobState::Done) {
        return Err(cannot_become(&job, "tried again"));
    }
    refuse_sealed(connection, id).await?;
    let mut frames: Vec<i64> =
        sqlx::query_scalar("DELETE FROM failures WHERE job_id = ? AND quarantined = 1 RETURNING frame")
            .bind(id)
            .fetch_all(&mut *connection)
            .await?;
    frames.sort_unstable();
    let changed = sqlx::query(concat!(
        "UPDATE jobs SET failed = failed - ?2, version = version + 1, digest = NULL, finished_ms = NULL,
                         state = CASE WHEN state = 'paused' THEN 'paused'
                                      WHEN done > 0 THEN 'running' ELSE 'queued' END
         WHERE id = ?1 RETURNING ",
        job_columns!(),
    ))
    .bind(id)
    .bind(frames.len() as i64)
    .fetch_one(connection)
    .await?;
    Ok(Retried {
        job: row(&changed)?,
        frames: frames.into_iter().map(|frame| frame as u64).collect(),
    })
}

pub(super) fn imported(job: JobRow) -> CatalogueError {
    CatalogueError::Imported {
        id: job.id,
        set: job.set.unwrap_or_default(),
    }
}

pub(super) fn cannot_become(job: &JobRow, to: &str) -> CatalogueError {
    CatalogueError::Transition {
        id: job.id.clone(),
        from: job.state.to_string(),
        to: to.to_owned(),
    }
}

pub(super) fn verified(found: &SqliteRow, side: Side) -> Result<JobRow, CatalogueError> {
    JOBS.verify(found, side)?;
    row(found)
}

pub(super) fn row(row: &SqliteRow) -> Result<JobRow, CatalogueError> {
    let mut cells = Cells::new(row);
    Ok(JobRow {
        id: cells.take()?,
        dataset: cells.take()?,
        state: cells
            .take::<String>()?
            .parse()
            .map_err(|message| CatalogueError::Failed { message })?,
        frames: cells.count()?,
        done: cells.count()?,
        failed: cells.count()?,
        bytes: cells.count()?,
        version: cells.count()?,
        created_at: cells.time()?,
        started_at: cells.optional_time()?,
        finished_at: cells.optional_time()?,
        digest: cells.take()?,
        warnings: Vec::new(),
        priority: cells.take()?,
        spec_digest: cells.take()?,
        set: cells.take()?,
        owner: cells.take()?,
        price: read_price(cells.take()?, cells.take()?),
        unproven: cells.take::<Option<i64>>()?.unwrap_or(0) as u64,
        mixed: cells.take::<Option<bool>>()?.unwrap_or(false),
        distrusted: cells.take::<Option<bool>>()?.unwrap_or(false),
    })
}

fn read_price(price_ms: Option<i64>, bytes: Option<i64>) -> Option<Price> {
    let (price_ms, bytes) = price_ms.zip(bytes)?;
    Some(Price {
        slot_seconds: price_ms as f64 / 1000.0,
        bytes: bytes.max(0) as u64,
    })
}
