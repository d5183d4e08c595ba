//! A catalogue in a folder of its own.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use catalogue::{Catalogue, DatasetRow, FailureRow, OpenJob};
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{AssertSqlSafe, ConnectOptions, Connection, Executor};

pub(crate) struct Fixture {
    pub(crate) catalogue: Arc<Catalogue>,
    pub(crate) folder: tempfile::TempDir,
}

impl Fixture {
    pub(crate) async fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let catalogue = open(&folder).await;
        Self { catalogue, folder }
    }

    /// A job with images of its first `done` frames.
    pub(crate) async fn job(&self, id: &str, dataset: &str, frames: u64, done: u64) {
        let job = synthetic::job(id, dataset, frames, 1000);
        self.catalogue.insert_job(job).await.unwrap();
        synthetic::fill(&self.catalogue, id, 0..done, 2000).await.unwrap();
    }

    pub(crate) async fn give_up(&self, job: &str, frame: u64) {
        self.catalogue
            .record_strike(job, failure(frame, 3, "boom", true))
            .await
            .unwrap();
    }

    /// What is left of a job that has not ended.
    pub(crate) async fn open_job(&self, id: &str) -> OpenJob {
        let row = self.catalogue.job(id).await.unwrap().unwrap();
        self.catalogue.open_job(row).await.unwrap()
    }

    pub(crate) async fn datasets(&self) -> Vec<DatasetRow> {
        self.catalogue.datasets(1000, None).await.unwrap().items
    }

    pub(crate) async fn all_failures(&self, job: &str) -> Vec<FailureRow> {
        self.catalogue.failures(job, None, u32::MAX).await.unwrap()
    }

    pub(crate) fn file(&self) -> PathBuf {
        self.folder.path().join("catalogue.sqlite")
    }

    pub(crate) async fn counts(&self) -> BTreeMap<String, u64> {
        counts(&self.file()).await
    }

    pub(crate) async fn is_sound(&self) {
        assert_eq!(self.catalogue.integrity_check().await.unwrap(), [""; 0]);
    }

    /// Changes the file behind the catalogue's back.
    pub(crate) async fn sabotage(&self, sql: &'static str) {
        sabotage(&self.file(), sql).await;
    }

    /// As after a kill: nothing is closed in order.
    pub(crate) async fn reopen(self) -> Self {
        let Self { catalogue, folder } = self;
        drop(catalogue);
        let catalogue = open(&folder).await;
        Self { catalogue, folder }
    }
}

pub(crate) fn failure(frame: u64, strikes: u32, error: &str, quarantined: bool) -> FailureRow {
    FailureRow {
        frame,
        strikes,
        quarantined,
        error: error.to_owned(),
    }
}

async fn open(folder: &tempfile::TempDir) -> Arc<Catalogue> {
    let path = folder.path().join("catalogue.sqlite");
    Arc::new(Catalogue::open(&path, &synthetic::metrics()).await.unwrap())
}

/// Runs statements on a file that may not be there yet.
pub(crate) async fn sabotage(path: &Path, sql: &str) {
    let options = SqliteConnectOptions::new().filename(path).create_if_missing(true);
    let mut connection = options.connect().await.unwrap();
    connection.execute(AssertSqlSafe(sql.to_owned())).await.unwrap();
    connection.close().await.unwrap();
}

/// The number of rows of every table in the file of a catalogue, also of jobs that are being deleted.
async fn counts(file: &Path) -> BTreeMap<String, u64> {
    let mut connection = SqliteConnectOptions::new()
        .filename(file)
        .connect()
        .await
        .unwrap();
    let tables: Vec<String> = sqlx::query_scalar("SELECT name FROM sqlite_schema WHERE type = 'table'")
        .fetch_all(&mut connection)
        .await
        .unwrap();
    let mut counts = BTreeMap::new();
    for table in tables {
        let sql = AssertSqlSafe(format!("SELECT count(*) FROM {table}"));
        let rows: i64 = sqlx::query_scalar(sql).fetch_one(&mut connection).await.unwrap();
        counts.insert(table, rows as u64);
    }
    connection.close().await.unwrap();
    counts
}
