//! The catalogue as its users see it.

use std::path::Path;
use std::str::FromStr;
use std::sync::Mutex;
use std::time::Duration;

use spec::{ArtifactEntry, FrameRecord};
use sqlx::sqlite::{
    SqliteConnectOptions, SqliteJournalMode, SqlitePool, SqlitePoolOptions, SqliteSynchronous,
};
use sqlx::{AssertSqlSafe, ConnectOptions, Executor, Row};
use tokio::task::JoinHandle;

use crate::columns::Columns;
use crate::error::CatalogueError;
use crate::filter::FilterError;
use crate::types::{
    Counts, DatasetRow, FailureRow, GroupStats, ImageQuery, ImageRow, InsertImage, InsertJob, JobRow,
    JobState, NewJob, OpenJob, Page, SceneRow,
};
use crate::writer::{Write, Writer};
use crate::{images, jobs, page, recovery, scenes, stats};

/// Earlier versions can damage the write-ahead log when it is reset.
const LEAST_SQLITE: &str = "3.51.3";
/// Questions that run side by side; more would only compete for the same cache.
const READERS: u32 = 8;
/// The longest a question may take.
const QUESTION_LIMIT: Duration = Duration::from_secs(20);
/// How long a connection waits for a lock of another process, such as a backup.
const LOCK_WAIT: Duration = Duration::from_secs(5);

/// A catalogue: one writer, several readers.
pub struct Catalogue {
    columns: Columns,
    readers: SqlitePool,
    writer: Mutex<Option<Writer>>,
    task: Mutex<Option<JoinHandle<()>>>,
}

impl Catalogue {
    /// Opens or creates a catalogue whose images have these metrics (`uiqm`, `uiqm@table1`, …).
    ///
    /// # Errors
    /// [`CatalogueError::Open`], [`CatalogueError::SqliteTooOld`].
    pub async fn open(path: &Path, metrics: &[String]) -> Result<Self, CatalogueError> {
        let unusable = |error: &dyn std::fmt::Display| CatalogueError::Open {
            path: path.to_owned(),
            reason: error.to_string(),
        };
        let options = SqliteConnectOptions::new()
            .filename(path)
            .create_if_missing(true)
            .journal_mode(SqliteJournalMode::Wal)
            .synchronous(SqliteSynchronous::Full)
            .foreign_keys(true)
            .busy_timeout(LOCK_WAIT)
            .disable_statement_logging();
        let mut connection = options.connect().await.map_err(|e| unusable(&e))?;
        let version: String = sqlx::query_scalar("SELECT sqlite_version()")
            .fetch_one(&mut connection)
            .await?;
        if numbers(&version) < numbers(LEAST_SQLITE) {
            return Err(CatalogueError::SqliteTooOld {
                version,
                least: LEAST_SQLITE,
            });
        }
        sqlx::migrate!("../../migrations")
            .run(&mut connection)
            .await
            .map_err(|e| unusable(&e))?;
        let columns = Columns::new(metrics);
        add_columns(&mut connection, &columns).await?;
        let readers = SqlitePoolOptions::new()
            .max_connections(READERS)
            .connect_with(options.pragma("query_only", "ON"))
            .await
            .map_err(|e| unusable(&e))?;
        let (writer, task) = Writer::start(connection, columns.clone());
        Ok(Self {
            columns,
            readers,
            writer: Mutex::new(Some(writer)),
            task: Mutex::new(Some(task)),
        })
    }

    /// Ends the writer after what it has taken on, and closes all connections.
    pub async fn close(&self) {
        drop(
            self.writer
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner)
                .take(),
        );
        let task = self
            .task
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
            .take();
        if let Some(task) = task {
            let _ = task.await;
        }
        self.readers.close().await;
    }

    fn writer(&self) -> Result<Writer, CatalogueError> {
        self.writer
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
            .clone()
            .ok_or(CatalogueError::Closed)
    }

    /// Stores a job, or finds the one that the same key stored. One row, however many frames.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn insert_job(&self, job: NewJob) -> Result<InsertJob, CatalogueError> {
        self.writer()?
            .write(|answer| Write::InsertJob(Box::new(job), answer))
            .await
    }

    /// Changes where a job stands.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`], [`CatalogueError::Transition`].
    pub async fn set_state(&self, id: &str, state: JobState) -> Result<JobRow, CatalogueError> {
        self.writer()?
            .write(|answer| Write::SetState(id.to_owned(), state, answer))
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
        let strike = Box::new(jobs::Strike {
            job: job.to_owned(),
            failure,
        });
        self.writer()?.write(|answer| Write::Strike(strike, answer)).await
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
        let image = Box::new(images::NewImage::new(job, record, now_ms)?);
        self.writer()?
            .write(|answer| Write::InsertImage(image, answer))
            .await
    }

    /// Stores a scene unless one of the same content is there; answers the id of the one that is.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn insert_scene(&self, scene: SceneRow) -> Result<String, CatalogueError> {
        self.writer()?
            .write(|answer| Write::InsertScene(Box::new(scene), answer))
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

    /// Failed frames of a job in frame order.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn failures(&self, job: &str) -> Result<Vec<FailureRow>, CatalogueError> {
        within(recovery::failures(&mut *self.reader().await?, job)).await
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

    /// Rows of every table.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn counts(&self) -> Result<Counts, CatalogueError> {
        let row = sqlx::query(
            "SELECT (SELECT count(*) FROM jobs), (SELECT count(*) FROM images), (SELECT count(*) FROM measurements),
                    (SELECT count(*) FROM artifacts), (SELECT count(*) FROM scenes), (SELECT count(*) FROM failures),
                    (SELECT count(*) FROM idempotency_keys)",
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
        })
    }

    async fn reader(&self) -> Result<sqlx::pool::PoolConnection<sqlx::Sqlite>, CatalogueError> {
        match self.readers.acquire().await {
            Err(sqlx::Error::PoolClosed) => Err(CatalogueError::Closed),
            acquired => Ok(acquired?),
        }
    }
}

async fn within<T>(answer: impl Future<Output = Result<T, CatalogueError>>) -> Result<T, CatalogueError> {
    let late = |_| CatalogueError::Timeout {
        seconds: QUESTION_LIMIT.as_secs(),
    };
    tokio::time::timeout(QUESTION_LIMIT, answer).await.map_err(late)?
}

/// Adds the wide columns that are not there yet. A metric that is gone from the registry keeps its column.
async fn add_columns(
    connection: &mut sqlx::SqliteConnection,
    columns: &Columns,
) -> Result<(), CatalogueError> {
    for column in columns.added() {
        let there: i64 = sqlx::query_scalar("SELECT count(*) FROM pragma_table_info(?) WHERE name = ?")
            .bind(column.table)
            .bind(&column.name)
            .fetch_one(&mut *connection)
            .await?;
        if there == 0 {
            // Names come from the registries of the program, never from a request.
            let name = column.name.replace('"', "");
            let statement = format!(
                "ALTER TABLE {} ADD COLUMN \"{name}\" {}",
                column.table, column.kind
            );
            connection.execute(AssertSqlSafe(statement)).await?;
        }
    }
    Ok(())
}

fn numbers(version: &str) -> Vec<u32> {
    version.split('.').map(|part| part.parse().unwrap_or(0)).collect()
}
