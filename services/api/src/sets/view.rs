//! A set as clients see it.

use catalogue::{JobRow, JobState, UnixMs};
use serde::Serialize;
use utoipa::ToSchema;

use super::Sets;
use super::follow::Last;
use crate::http::problem::{Problem, found};

/// A set whose images are imported into a job of their own.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Set)]
pub(crate) struct SetView {
    /// The job that its images belong to. It is also what names the set.
    #[schema(example = "job_0198c0ffee007000800000000000000a")]
    job: String,
    /// Where it lies.
    #[schema(example = "s3://reef/tour")]
    url: String,
    /// The dataset that its images join.
    #[schema(example = "shaft-v1")]
    dataset: String,
    /// How far the job is: frames are counted when their shard is imported.
    state: JobState,
    /// Number of frames.
    frames: u64,
    /// Frames whose image is imported.
    done: u64,
    /// Frames that have no image.
    failed: u64,
    /// Shards that are imported.
    shards: u64,
    /// Whether the service looks for further shards. It does until every frame has ended.
    followed: bool,
    /// When it looked last; null: not since it was started.
    #[schema(value_type = Option<String>, format = DateTime)]
    looked_at: Option<UnixMs>,
    /// Why that look ended early; null: it did not.
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

    /// The set that is imported into a job.
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
