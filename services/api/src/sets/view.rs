//! A set as shown to clients.

use catalogue::{JobRow, JobState, UnixMs};
use serde::Serialize;
use utoipa::ToSchema;

use super::Sets;
use super::follow::Last;
use crate::http::problem::{Problem, found};

/// A set whose images are imported into a separate job.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Set)]
pub(crate) struct SetView {
    /// The job of its images, which also identifies the set.
    #[schema(example = "job_0198c0ffee007000800000000000000a")]
    job: String,
    /// Location.
    #[schema(example = "s3://reef/tour")]
    url: String,
    /// The dataset of its images.
    #[schema(example = "shaft-v1")]
    dataset: String,
    /// State of the job. Frames count when their shard is imported.
    state: JobState,
    /// Number of frames.
    frames: u64,
    /// Imported images.
    done: u64,
    /// Frames without an image.
    failed: u64,
    /// Imported shards.
    shards: u64,
    /// Whether the service polls for further shards, until every frame has ended.
    followed: bool,
    /// Time of the last poll; null: none since the start of the service.
    #[schema(value_type = Option<String>, format = DateTime)]
    looked_at: Option<UnixMs>,
    /// Why that poll ended early; null: it did not.
    error: Option<String>,
}

impl Sets {
    /// Every set, newest first.
    pub(super) async fn all(&self) -> Result<Vec<SetView>, Problem> {
        let mut views = Vec::new();
        for row in self.jobs.catalogue.imported_jobs().await? {
            views.push(self.view(row).await?);
        }
        Ok(views)
    }

    /// The set of a job.
    pub(super) async fn get(&self, job: &str) -> Result<SetView, Problem> {
        let row = self.jobs.catalogue.job(job).await?;
        let row = found(row.filter(|row| row.set.is_some()), "set with the job", job)?;
        self.view(row).await
    }

    pub(super) async fn view(&self, row: JobRow) -> Result<SetView, Problem> {
        let (shards, _) = self.jobs.catalogue.imported_extent(&row.id).await?;
        let followed = self.followed().get(&row.id).cloned();
        let last = followed.map(|followed| followed.last().clone());
        let Last { goes_on, at, error } = last.unwrap_or_default();
        Ok(SetView {
            job: row.id,
            url: row.set.unwrap_or_default(),
            dataset: row.dataset,
            state: row.state,
            frames: row.frames,
            done: row.done,
            failed: row.failed,
            shards,
            followed: goes_on,
            looked_at: at,
            error,
        })
    }
}
