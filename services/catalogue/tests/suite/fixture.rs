//! A catalogue in a folder of its own.

use std::path::Path;
use std::sync::Arc;

use catalogue::{Catalogue, FailureRow, OpenJob, synthetic};
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

    pub(crate) async fn all_failures(&self, job: &str) -> Vec<FailureRow> {
        self.catalogue.failures(job, None, u32::MAX).await.unwrap()
    }

    pub(crate) async fn is_sound(&self) {
        assert_eq!(self.catalogue.integrity_check().await.unwrap(), [""; 0]);
    }

    /// Changes the file behind the catalogue's back.
    pub(crate) async fn sabotage(&self, sql: &'static str) {
        sabotage(&self.folder.path().join("catalogue.sqlite"), sql).await;
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
