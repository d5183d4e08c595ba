//! A job on its way in, and the jobs that it may repeat.

use client::{JobRow, JobState};
use sqlx::Row;
use sqlx::sqlite::SqliteConnection;

use super::rows::{known_job, of_set, row, verified};
use crate::catalogue::Catalogue;
use crate::digests::row_digests::Side;
use crate::digests::tables::{KEYS, digested_job_columns, job_columns};
use crate::error::CatalogueError;
use crate::types::{InsertJob, NewJob};

impl Catalogue {
    /// Stores a job, or returns the one of an earlier submission with its key.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn insert_job(&self, job: NewJob) -> Result<InsertJob, CatalogueError> {
        self.write(move |c| Box::pin(async move { insert(c, &job).await }))
            .await
    }

    /// Whether the key of a submission was used before.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn has_key(&self, job: &NewJob) -> Result<bool, CatalogueError> {
        let Some(key) = &job.idempotency else {
            return Ok(false);
        };
        let found: i64 =
            sqlx::query_scalar("SELECT count(*) FROM idempotency_keys WHERE owner = ? AND key = ?")
                .bind(&key.owner)
                .bind(&key.key)
                .fetch_one(&mut *self.reader().await?)
                .await?;
        Ok(found > 0)
    }

    /// An existing job with the same description and dataset, with a warning about it. [`Catalogue::insert_job`] returns it if it is
    /// done.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn duplicate(&self, job: &NewJob) -> Result<Option<JobRow>, CatalogueError> {
        find_duplicate(&mut *self.reader().await?, job, Side::Reader).await
    }
}

/// Stores a job, unless it repeats one.
pub(super) async fn insert(
    connection: &mut SqliteConnection,
    job: &NewJob,
) -> Result<InsertJob, CatalogueError> {
    if let Some(key) = &job.idempotency {
        let known = sqlx::query(
            "SELECT owner, key, body_digest, job_id, row_digest FROM idempotency_keys WHERE owner = ? AND key = ?",
        )
        .bind(&key.owner)
        .bind(&key.key)
        .fetch_optional(&mut *connection)
        .await?;
        if let Some(known) = known {
            KEYS.verify(&known, Side::Writer)?;
            let (digest, id): (String, String) = (known.try_get(2)?, known.try_get(3)?);
            return if digest == key.body_digest {
                Ok(InsertJob::Replayed(known_job(connection, &id).await?))
            } else {
                Ok(InsertJob::KeyConflict)
            };
        }
    }
    if let Some(set) = &job.set
        && let Some(known) = of_set(connection, set, Side::Writer).await?
    {
        return Ok(InsertJob::Replayed(known));
    }
    let warnings = match find_duplicate(connection, job, Side::Writer).await? {
        Some(duplicate) if duplicate.state == JobState::Done => {
            keep_key(connection, job, &duplicate.id).await?;
            return Ok(InsertJob::Complete(duplicate));
        }
        Some(duplicate) => duplicate.warnings,
        None => Vec::new(),
    };
    let price = job.charge.as_ref().map(|charge| charge.price);
    let stored = sqlx::query(concat!(
        "INSERT INTO jobs (id, dataset, spec, spec_digest, frames, priority, state, created_ms, set_location, owner,
                           price_ms, price_bytes)
         VALUES (?, ?, ?, ?, ?, ?, 'queued', ?, ?, ?, ?, ?) RETURNING ",
        job_columns!(),
    ))
    .bind(&job.id)
    .bind(&job.dataset)
    .bind(&job.spec)
    .bind(&job.spec_digest)
    .bind(job.frames as i64)
    .bind(job.priority)
    .bind(job.created_at.0 as i64)
    .bind(&job.set)
    .bind(job.charge.as_ref().map(|charge| &charge.owner))
    .bind(price.map(|price| (price.slot_seconds * 1000.0).ceil() as i64))
    .bind(price.map(|price| i64::try_from(price.bytes).unwrap_or(i64::MAX)))
    .fetch_one(&mut *connection)
    .await?;
    sqlx::query(
        "INSERT INTO datasets (name, jobs) VALUES (?, 1) ON CONFLICT (name) DO UPDATE SET jobs = jobs + 1",
    )
    .bind(&job.dataset)
    .execute(&mut *connection)
    .await?;
    keep_key(connection, job, &job.id).await?;
    Ok(InsertJob::Created(JobRow {
        warnings,
        ..row(&stored)?
    }))
}

/// Stores the key under which a repeated submission returns the job `id`.
async fn keep_key(connection: &mut SqliteConnection, job: &NewJob, id: &str) -> Result<(), CatalogueError> {
    if let Some(key) = &job.idempotency {
        sqlx::query("INSERT INTO idempotency_keys (owner, key, body_digest, job_id) VALUES (?, ?, ?, ?)")
            .bind(&key.owner)
            .bind(&key.key)
            .bind(&key.body_digest)
            .bind(id)
            .execute(connection)
            .await?;
    }
    Ok(())
}

/// Another job with the same description and dataset that has images or will have them, preferably a completed one; `None` if the
/// submission requests the images again. Its warnings explain what that means for a job that repeats it.
pub(super) async fn find_duplicate(
    connection: &mut SqliteConnection,
    job: &NewJob,
    side: Side,
) -> Result<Option<JobRow>, CatalogueError> {
    let found = of_description(connection, job, side).await?;
    Ok(found.map(|mut duplicate| {
        let JobRow { id, dataset, state, .. } = &duplicate;
        let warning = match state {
            JobState::Done => format!(
                "dataset `{dataset}` has every image of this description already, from {id}: nothing is rendered; with `again` \
                 they are rendered again"
            ),
            _ => format!(
                "{id} in dataset `{dataset}` has the same description and is {state}: the dataset will have its images twice"
            ),
        };
        duplicate.warnings.push(warning);
        duplicate
    }))
}

async fn of_description(
    connection: &mut SqliteConnection,
    job: &NewJob,
    side: Side,
) -> Result<Option<JobRow>, CatalogueError> {
    if job.again {
        return Ok(None);
    }
    let found = sqlx::query(concat!(
        "SELECT ",
        digested_job_columns!(),
        " FROM jobs WHERE spec_digest = ? AND dataset = ? AND state != 'cancelled'
           AND id NOT IN (SELECT job_id FROM deletions) ORDER BY state = 'done' DESC, id DESC LIMIT 1",
    ))
    .bind(&job.spec_digest)
    .bind(&job.dataset)
    .fetch_optional(connection)
    .await?;
    found.as_ref().map(|row| verified(row, side)).transpose()
}
