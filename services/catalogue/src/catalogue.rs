//! The catalogue as its users see it.

use std::path::PathBuf;
use std::str::FromStr;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use spec::{ArtifactEntry, FrameRecord};
use sqlx::Row;
use sqlx::sqlite::{SqliteConnection, SqlitePool};
use tokio::task::JoinHandle;

use crate::columns::Columns;
use crate::error::CatalogueError;
use crate::filter::FilterError;
use crate::insert::NewImage;
use crate::types::{
    Counts, DatasetRow, FailureRow, GroupStats, ImageQuery, ImageRow, InsertImage, InsertJob, JobRow,
    JobState, NewJob, OpenJob, Page, SceneRow,
};
use crate::writer::{Running, Writer};
use crate::{images, jobs, page, recovery, scenes, stats};

/// The longest a question may take.
const QUESTION_LIMIT: Duration = Duration::from_secs(20);
/// A catalogue: one writer, several readers.
pub struct Catalogue {
    pub(crate) path: PathBuf,
    pub(crate) columns: Columns,
    pub(crate) readers: SqlitePool,
    pub(crate) writer: Mutex<Option<Writer>>,
    pub(crate) task: Mutex<Option<JoinHandle<()>>>,
}

impl Catalogue {
    /// Stores a job, or finds the one that the same key stored. One row, however many frames.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn insert_job(&self, job: NewJob) -> Result<InsertJob, CatalogueError> {
        self.write(move |c| Box::pin(async move { jobs::insert(c, &job).await }))
            .await
    }

    /// Changes where a job stands.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`], [`CatalogueError::Transition`].
    pub async fn set_state(&self, id: &str, state: JobState) -> Result<JobRow, CatalogueError> {
        let id = id.to_owned();
        self.write(move |c| Box::pin(async move { jobs::set_state(c, &id, state).await }))
            .await
    }

    /// Writes a failed attempt down.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn record_strike(
        &self,
        job: &str,
        frame: u64,
        strikes: u32,
        error: &str,
        quarantined: bool,
    ) -> Result<(), CatalogueError> {
        let failure = FailureRow {
            frame,
            strikes,
            quarantined,
            error: error.to_owned(),
        };
        let job = job.to_owned();
        self.write(move |c| Box::pin(async move { jobs::strike(c, &job, &failure).await }))
            .await
    }

    /// Stores an image with its measurements, artifact names and the job's counters, all or nothing.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`] when the job is gone.
    pub async fn insert_image(
        &self,
        job: &str,
        record: &FrameRecord,
        now_ms: u64,
    ) -> Result<InsertImage, CatalogueError> {
        let image = NewImage::new(&self.columns, job, record, now_ms)?;
        self.writer()?.insert(image).await
    }

    /// Stores a scene unless one of the same content is there; answers the id of the one that is.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn insert_scene(&self, scene: SceneRow) -> Result<String, CatalogueError> {
        self.write(move |c| Box::pin(async move { scenes::insert(c, &scene).await }))
            .await
    }

    /// A job.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn job(&self, id: &str) -> Result<Option<JobRow>, CatalogueError> {
        jobs::get(&mut *self.reader().await?, id).await
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
        if let Some(Err(message)) = state.as_deref().map(JobState::from_str) {
            return Err(FilterError {
                position: 0,
                message,
                did_you_mean: None,
            }
            .into());
        }
        let asked = jobs::Asked {
            dataset,
            state,
            limit,
            cursor,
        };
        within(jobs::list(&mut *self.reader().await?, &asked)).await
    }

    /// Jobs that have not ended, with what is left of them.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn open_jobs(&self) -> Result<Vec<OpenJob>, CatalogueError> {
        recovery::open_jobs(&mut *self.reader().await?).await
    }

    /// A job that has not ended, with what is left of it.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn open_job(&self, id: &str) -> Result<Option<OpenJob>, CatalogueError> {
        recovery::open_job(&mut *self.reader().await?, id).await
    }

    /// Failed frames of a job in frame order, those after a frame.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn failures(
        &self,
        job: &str,
        after: Option<u64>,
        limit: u32,
    ) -> Result<Vec<FailureRow>, CatalogueError> {
        within(recovery::failures(&mut *self.reader().await?, job, after, limit)).await
    }

    /// Images of a job in frame order, those after a frame.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn results(
        &self,
        job: &str,
        after: Option<u64>,
        limit: u32,
    ) -> Result<Vec<ImageRow>, CatalogueError> {
        within(images::after(&mut *self.reader().await?, job, after, limit)).await
    }

    /// An image.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn image(&self, job: &str, frame: u64) -> Result<Option<ImageRow>, CatalogueError> {
        images::get(&mut *self.reader().await?, job, frame).await
    }

    /// The name of an artifact's bytes.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn artifact(
        &self,
        job: &str,
        frame: u64,
        kind: &str,
    ) -> Result<Option<ArtifactEntry>, CatalogueError> {
        images::artifact(&mut *self.reader().await?, job, frame, kind).await
    }

    /// A page of images.
    ///
    /// # Errors
    /// [`CatalogueError::Filter`] for filter, order or fields; [`CatalogueError::Cursor`]; [`CatalogueError::Timeout`].
    pub async fn images(&self, query: ImageQuery) -> Result<Page<serde_json::Value>, CatalogueError> {
        within(page::images(&mut *self.reader().await?, &self.columns, &query)).await
    }

    /// Statistics of metrics over a dataset, for each value of a column.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`] for the dataset, [`CatalogueError::Filter`] for names and filter.
    pub async fn stats(
        &self,
        dataset: &str,
        metrics: &[String],
        group_by: Option<&str>,
        filter: Option<&str>,
    ) -> Result<Vec<GroupStats>, CatalogueError> {
        let question = stats::Question {
            dataset,
            metrics,
            group_by,
            filter,
        };
        within(stats::stats(&mut *self.reader().await?, &self.columns, &question)).await
    }

    /// All datasets by name.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn datasets(&self) -> Result<Vec<DatasetRow>, CatalogueError> {
        let rows = sqlx::query("SELECT name, images, bytes, jobs FROM datasets ORDER BY name")
            .fetch_all(&mut *self.reader().await?)
            .await?;
        let row = |row: sqlx::sqlite::SqliteRow| -> Result<DatasetRow, sqlx::Error> {
            let number = |at: usize| row.try_get::<i64, _>(at).map(|n| n as u64);
            Ok(DatasetRow {
                name: row.try_get(0)?,
                images: number(1)?,
                bytes: number(2)?,
                jobs: number(3)?,
            })
        };
        Ok(rows.into_iter().map(row).collect::<Result<_, _>>()?)
    }

    /// A scene.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn scene(&self, id: &str) -> Result<Option<SceneRow>, CatalogueError> {
        scenes::get(&mut *self.reader().await?, id).await
    }

    /// Scenes, newest first.
    ///
    /// # Errors
    /// [`CatalogueError::Cursor`].
    pub async fn scenes(&self, limit: u32, cursor: Option<String>) -> Result<Page<SceneRow>, CatalogueError> {
        scenes::list(&mut *self.reader().await?, limit, cursor.as_deref()).await
    }

    /// Rows of every table, also of jobs that are being deleted.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn counts(&self) -> Result<Counts, CatalogueError> {
        let row = sqlx::query(
            "SELECT (SELECT count(*) FROM jobs), (SELECT count(*) FROM images), (SELECT count(*) FROM measurements),
                    (SELECT count(*) FROM artifacts), (SELECT count(*) FROM scenes), (SELECT count(*) FROM failures),
                    (SELECT count(*) FROM idempotency_keys), (SELECT count(*) FROM deletions),
                    (SELECT count(*) FROM orphans)",
        )
        .fetch_one(&mut *self.reader().await?)
        .await?;
        let count = |at: usize| row.try_get::<i64, _>(at).map(|n| n as u64);
        Ok(Counts {
            jobs: count(0)?,
            images: count(1)?,
            measurements: count(2)?,
            artifacts: count(3)?,
            scenes: count(4)?,
            failures: count(5)?,
            idempotency_keys: count(6)?,
            deletions: count(7)?,
            orphans: count(8)?,
        })
    }

    /// Brings a change to the writer and waits until it is durable.
    pub(crate) async fn write<T: Send + 'static>(
        &self,
        change: impl for<'c> FnOnce(&'c mut SqliteConnection) -> Running<'c, Result<T, CatalogueError>>
        + Send
        + 'static,
    ) -> Result<T, CatalogueError> {
        self.writer()?.write(change).await
    }

    fn writer(&self) -> Result<Writer, CatalogueError> {
        let writer = self.writer.lock().unwrap_or_else(PoisonError::into_inner);
        writer.clone().ok_or(CatalogueError::Closed)
    }

    pub(crate) async fn reader(&self) -> Result<sqlx::pool::PoolConnection<sqlx::Sqlite>, CatalogueError> {
        match self.readers.acquire().await {
            Err(sqlx::Error::PoolClosed) => Err(CatalogueError::Closed),
            acquired => Ok(acquired?),
        }
    }
}

pub(crate) async fn within<T>(
    answer: impl Future<Output = Result<T, CatalogueError>>,
) -> Result<T, CatalogueError> {
    let late = |_| CatalogueError::Timeout {
        seconds: QUESTION_LIMIT.as_secs(),
    };
    tokio::time::timeout(QUESTION_LIMIT, answer).await.map_err(late)?
}
