//! The catalogue's connections, and the paths of reads and writes. The operations are in the folders of their topics.

use client::{DatasetRow, Page};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use sqlx::pool::PoolConnection;
use sqlx::sqlite::{Sqlite, SqliteConnection, SqlitePool, SqliteRow};
use tokio::task::JoinHandle;

use crate::commit::writer::{Running, Writer};
use crate::damage::{DamageLog, ImageDamage};
use crate::digests::row_digests::Side;
use crate::digests::tables::DATASETS;
use crate::error::CatalogueError;
use crate::image_id::ImageId;
use crate::query::cache::JobCache;
use crate::query::cells::Cells;
use crate::query::columns::Columns;
use crate::query::cursor;
use crate::query::list_page::list_page;
use crate::replica::files::Replica;

/// Time limit of a query.
const QUERY_LIMIT: Duration = Duration::from_secs(20);

/// A catalogue: one writer, several readers.
pub struct Catalogue {
    pub(crate) path: PathBuf,
    pub(crate) columns: Columns,
    pub(crate) replica: Arc<Replica>,
    /// The measured pictures and artifact kinds of large jobs, for lists of columns.
    pub(crate) job_cache: JobCache,
    pub(crate) readers: SqlitePool,
    pub(crate) reads: AtomicU64,
    pub(crate) damage: DamageLog,
    pub(crate) writer: Mutex<Option<Writer>>,
    pub(crate) task: Mutex<Option<JoinHandle<()>>>,
}

impl Catalogue {
    /// A page of datasets by name.
    ///
    /// # Errors
    /// [`CatalogueError`], also [`CatalogueError::Cursor`].
    pub async fn datasets(
        &self,
        limit: u32,
        cursor: Option<String>,
    ) -> Result<Page<DatasetRow>, CatalogueError> {
        let identity = cursor::query_identity(&[Some("datasets")]);
        let after = cursor::read_id(&identity, cursor.as_deref())?;
        let rows = sqlx::query(
            "SELECT name, images, bytes, jobs, row_digest FROM datasets WHERE ?1 IS NULL OR name > ?1 ORDER BY name LIMIT ?2",
        )
        .bind(after)
        .bind(i64::from(limit) + 1)
        .fetch_all(&mut *self.reader().await?)
        .await?;
        list_page(&identity, &rows, limit, &self.damage, dataset)
    }

    /// A dataset by its name, but not a sealed version.
    pub(crate) async fn unsealed(&self, name: &str) -> Result<Option<DatasetRow>, CatalogueError> {
        let row = sqlx::query("SELECT name, images, bytes, jobs, row_digest FROM datasets WHERE name = ?")
            .bind(name)
            .fetch_optional(&mut *self.reader().await?)
            .await?;
        row.as_ref().map(dataset).transpose()
    }

    /// Damage that was found since the catalogue was opened, here or in the packs, and is not restored.
    #[must_use]
    pub fn damage(&self) -> Vec<String> {
        self.damage.texts()
    }

    /// Records damage.
    pub fn note_damage(&self, what: &str) {
        self.damage.note(what.to_owned(), None);
    }

    /// Records that the bytes of an artifact of an image are damaged or missing.
    pub fn note_damaged_artifact(&self, image: &ImageId, what: &str) {
        let damage = ImageDamage {
            image: image.clone(),
            what: what.to_owned(),
        };
        self.damage.note(what.to_owned(), Some(damage));
    }

    /// The images with damaged rows or artifacts among the damage.
    #[must_use]
    pub fn damaged_images(&self) -> Vec<ImageDamage> {
        self.damage.images()
    }

    /// Waits until damage of another image is found.
    pub async fn wait_for_damaged_image(&self) {
        self.damage.wait_for_image().await;
    }

    /// Removes a restored image from the damage.
    pub fn forget_damage(&self, image: &ImageId) {
        self.damage.forget(image);
    }

    /// Notes the damage of a row outside of lists; returns the result unchanged.
    pub(crate) fn note_if_damaged<T>(&self, row: Result<T, CatalogueError>) -> Result<T, CatalogueError> {
        row.inspect_err(|error| self.damage.note_error(error))
    }

    /// Leaves a damaged row out of a list without which the service could not start.
    pub(crate) fn unless_damaged<T>(
        &self,
        row: Result<T, CatalogueError>,
    ) -> Option<Result<T, CatalogueError>> {
        match row {
            Err(error @ CatalogueError::Damaged { .. }) => {
                tracing::error!(%error, "left out");
                self.damage.note_error(&error);
                None
            }
            other => Some(other),
        }
    }

    /// Number of reads by this process, without those that are part of a change.
    #[must_use]
    pub fn reads(&self) -> u64 {
        self.reads.load(Ordering::Relaxed)
    }

    /// Sends a change to the writer and waits until it is durable.
    pub(crate) async fn write<T: Send + 'static>(
        &self,
        change: impl for<'c> FnOnce(&'c mut SqliteConnection) -> Running<'c, Result<T, CatalogueError>>
        + Send
        + 'static,
    ) -> Result<T, CatalogueError> {
        self.writer()?.write(change).await
    }

    pub(crate) fn writer(&self) -> Result<Writer, CatalogueError> {
        let writer = self.writer.lock().unwrap_or_else(PoisonError::into_inner);
        writer.clone().ok_or(CatalogueError::Closed)
    }

    pub(crate) async fn reader(&self) -> Result<PoolConnection<Sqlite>, CatalogueError> {
        self.reads.fetch_add(1, Ordering::Relaxed);
        match self.readers.acquire().await {
            Err(sqlx::Error::PoolClosed) => Err(CatalogueError::Closed),
            Err(sqlx::Error::PoolTimedOut) => Err(CatalogueError::Busy),
            acquired => Ok(acquired?),
        }
    }
}

fn dataset(row: &SqliteRow) -> Result<DatasetRow, CatalogueError> {
    DATASETS.verify(row, Side::Reader)?;
    let mut cells = Cells::new(row);
    Ok(DatasetRow {
        name: cells.take()?,
        images: cells.count()?,
        bytes: cells.count()?,
        jobs: cells.count()?,
    })
}

pub(crate) async fn within<T>(
    query: impl Future<Output = Result<T, CatalogueError>>,
) -> Result<T, CatalogueError> {
    tokio::time::timeout(QUERY_LIMIT, query)
        .await
        .map_err(|_| CatalogueError::Timeout {
            seconds: QUERY_LIMIT.as_secs(),
        })?
}
