//! Sealed versions of datasets: `tour@1` has the images that the jobs of `tour` had when it was sealed, for good.

use crate::query::scope::Scope;
use client::{DatasetRow, VersionRow};
use serde::Serialize;
use serde_json::Value;
use sqlx::Row;
use sqlx::sqlite::{SqliteConnection, SqliteRow};
use utoipa::ToSchema;

use crate::catalogue::Catalogue;
use crate::digests::row_digests::{Side, intact};
use crate::digests::tables::{JOBS, VERSION_JOBS, VERSIONS, job_columns};
use crate::error::CatalogueError;
use crate::query::cells::Cells;

/// A job of a sealed version.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct VersionJob {
    /// `job_…`.
    #[schema(example = "job_0198c0ffee007000800000000000000a")]
    pub id: String,
    /// Root of the Merkle tree over the digests of its images in the order of frames.
    pub root: String,
    /// Number of images.
    pub images: u64,
    /// Its description, which with the code version gives the same images again.
    #[schema(value_type = Object)]
    pub description: Value,
}

/// An image of a sealed version, as the catalogue has it in several places.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SealedImage {
    /// The frame.
    pub frame: u64,
    /// Its digest, a leaf of the Merkle tree.
    pub digest: String,
    /// Its record, JSON.
    pub record: String,
    /// Kind and digest of each stored artifact, in the order of kinds.
    pub artifacts: Vec<(String, String)>,
}

/// The columns of a [`VersionRow`], as [`row`] reads them.
macro_rules! columns {
    () => {
        "dataset, version, root, images, bytes, code_versions, created_ms, unsealed_ms, row_digest,
         (SELECT count(*) FROM version_jobs j WHERE j.dataset = versions.dataset AND j.version = versions.version)"
    };
}

impl Catalogue {
    /// The sealed versions of a dataset, the oldest first.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn versions(&self, dataset: &str) -> Result<Vec<VersionRow>, CatalogueError> {
        let rows = sqlx::query(concat!(
            "SELECT ",
            columns!(),
            " FROM versions WHERE dataset = ? AND unsealed_ms IS NULL ORDER BY version"
        ));
        let rows = rows.bind(dataset).fetch_all(&mut *self.reader().await?).await?;
        rows.iter().map(|found| row(found, Side::Reader)).collect()
    }

    /// A sealed version.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn version(&self, dataset: &str, version: u64) -> Result<Option<VersionRow>, CatalogueError> {
        get(&mut *self.reader().await?, dataset, version, Side::Reader).await
    }

    /// The jobs of a sealed version in the order of its root.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn version_jobs(&self, dataset: &str, version: u64) -> Result<Vec<VersionJob>, CatalogueError> {
        let mut reader = self.reader().await?;
        let rows = sqlx::query(
            "SELECT version_jobs.dataset, version_jobs.version, job_id, root, version_jobs.row_digest, spec, spec_digest
             FROM version_jobs JOIN jobs ON id = job_id
             WHERE version_jobs.dataset = ? AND version_jobs.version = ? ORDER BY spec_digest, root, id",
        )
        .bind(dataset)
        .bind(version as i64)
        .fetch_all(&mut *reader)
        .await?;
        let mut jobs = Vec::with_capacity(rows.len());
        for row in &rows {
            VERSION_JOBS.verify(row, Side::Reader)?;
            let id: String = row.try_get(2)?;
            let job = sqlx::query(concat!(
                "SELECT ",
                job_columns!(),
                ", row_digest, done FROM jobs WHERE id = ?"
            ))
            .bind(&id)
            .fetch_one(&mut *reader)
            .await?;
            JOBS.verify(&job, Side::Reader)?;
            jobs.push(VersionJob {
                root: row.try_get(3)?,
                images: job.try_get::<i64, _>(job.len() - 1)? as u64,
                description: serde_json::from_str(intact(&id, row.try_get(5)?, row.try_get(6)?)?)?,
                id,
            });
        }
        Ok(jobs)
    }

    /// Images of a job by frame, those after a frame.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn sealed_images(
        &self,
        job: &str,
        after: Option<u64>,
        limit: u32,
    ) -> Result<Vec<SealedImage>, CatalogueError> {
        let rows: Vec<(i64, String, String, String)> = sqlx::query_as(
            "SELECT frame, digest, coalesce((SELECT record FROM records r WHERE r.job_id = i.job_id AND r.frame = i.frame), ''),
                    (SELECT json_group_array(json_array(kind, digest)) FROM
                        (SELECT kind, digest FROM artifacts a WHERE a.job_id = i.job_id AND a.frame = i.frame ORDER BY kind))
             FROM images i WHERE job_id = ? AND frame > ? ORDER BY frame LIMIT ?",
        )
        .bind(job)
        .bind(after.map_or(-1, |frame| frame as i64))
        .bind(limit)
        .fetch_all(&mut *self.reader().await?)
        .await?;
        rows.into_iter()
            .map(
                |(frame, digest, record, artifacts): (i64, String, String, String)| {
                    Ok(SealedImage {
                        frame: frame as u64,
                        digest,
                        record,
                        artifacts: serde_json::from_str(&artifacts)?,
                    })
                },
            )
            .collect()
    }

    /// A dataset, or a sealed version of one, by its name.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn dataset(&self, name: &str) -> Result<Option<DatasetRow>, CatalogueError> {
        let scope = Scope::parse(name);
        let Some(version) = scope.version else {
            return self.unsealed(name).await;
        };
        let found = self.version(scope.dataset, version).await?;
        Ok(found.map(|row| DatasetRow {
            name: row.name,
            images: row.images,
            bytes: row.bytes,
            jobs: row.jobs,
        }))
    }
}

pub(super) async fn get(
    connection: &mut SqliteConnection,
    dataset: &str,
    version: u64,
    side: Side,
) -> Result<Option<VersionRow>, CatalogueError> {
    let found = sqlx::query(concat!(
        "SELECT ",
        columns!(),
        " FROM versions WHERE dataset = ? AND version = ? AND unsealed_ms IS NULL"
    ));
    let found = found.bind(dataset).bind(version as i64);
    found
        .fetch_optional(connection)
        .await?
        .as_ref()
        .map(|found| row(found, side))
        .transpose()
}

/// Refuses to change a sealed job.
pub(crate) async fn refuse_sealed(
    connection: &mut SqliteConnection,
    job: &str,
) -> Result<(), CatalogueError> {
    let sealed: Option<(String, i64)> =
        sqlx::query_as("SELECT dataset, version FROM version_jobs WHERE job_id = ? ORDER BY version LIMIT 1")
            .bind(job)
            .fetch_optional(connection)
            .await?;
    sealed.map_or(Ok(()), |(dataset, version)| {
        Err(CatalogueError::Sealed {
            job: job.to_owned(),
            version: format!("{dataset}@{version}"),
        })
    })
}

fn row(row: &SqliteRow, side: Side) -> Result<VersionRow, CatalogueError> {
    VERSIONS.verify(row, side)?;
    let mut cells = Cells::new(row);
    let (dataset, version) = (cells.take::<String>()?, cells.count()?);
    Ok(VersionRow {
        name: format!("{dataset}@{version}"),
        dataset,
        version,
        root: cells.take()?,
        images: cells.count()?,
        bytes: cells.count()?,
        code_versions: serde_json::from_str(cells.take()?)?,
        created_at: cells.time()?,
        jobs: {
            let (_unsealed, _digest) = (cells.optional_time()?, cells.take::<Option<i64>>()?);
            cells.count()?
        },
    })
}
