//! The requests that commands make, one function for each endpoint.

use serde::de::DeserializeOwned;

use crate::client::Client;
use crate::error::ClientError;
use crate::query::{encode, with_query};
use crate::views::{
    BackupView, CollectionRow, CollectionScene, DatasetDetail, DatasetRow, FailureRow, FrameWarning,
    JobPreview, JobRow, Page, SceneView, SetView, Statistics, VerifiedVersion, VersionRow,
};

/// A change of a job's state by its user.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JobChange {
    /// Stop it; its images stay.
    Cancel,
    /// Offer no more of its frames to workers.
    Pause,
    /// Offer them again.
    Resume,
    /// Try its failed frames again.
    RetryFailed,
    /// Let workers of any version and kind of machine render its frames.
    FinishElsewhere,
    /// Remove its images and render it from the beginning.
    StartAgain,
}

impl JobChange {
    fn segment(self) -> &'static str {
        match self {
            Self::Cancel => "cancel",
            Self::Pause => "pause",
            Self::Resume => "resume",
            Self::RetryFailed => "retry-failed",
            Self::FinishElsewhere => "finish-elsewhere",
            Self::StartAgain => "start-again",
        }
    }
}

/// A query for statistics; lists are separated by commas.
#[derive(Debug, Clone, Copy, Default)]
pub struct StatisticsQuery<'a> {
    /// Metrics.
    pub metrics: &'a str,
    /// A column whose values are the groups.
    pub group_by: &'a str,
    /// Columns and bins that are the groups, instead of `group_by`.
    pub by: &'a str,
    /// Only images that fulfill this.
    pub filter: &'a str,
}

#[allow(
    clippy::missing_errors_doc,
    reason = "every request fails with a `ClientError`"
)]
impl Client {
    /// Submits a job description. With `again`, also one whose images its dataset already has.
    pub fn submit_job(
        &self,
        description: &[u8],
        key: Option<&str>,
        again: bool,
    ) -> Result<JobRow, ClientError> {
        let headers: Vec<(&str, &str)> = key.map(|key| ("idempotency-key", key)).into_iter().collect();
        let path = with_query("/v1/jobs", &[("again", again.then_some("true"))]);
        self.post(&path, &headers, description)
    }

    /// The size and estimated cost of a job, which is not submitted.
    pub fn preview_job(&self, description: &[u8]) -> Result<JobPreview, ClientError> {
        self.post("/v1/jobs/preview?frames=0", &[], description)
    }

    /// The job of an id.
    pub fn job(&self, id: &str) -> Result<Option<JobRow>, ClientError> {
        self.find(&format!("/v1/jobs/{}", encode(id)))
    }

    /// The job of an id, once its version is greater than `since` or after `wait_s` seconds, at most 60.
    pub fn await_job(&self, id: &str, since: u64, wait_s: u64) -> Result<JobRow, ClientError> {
        self.get(&format!("/v1/jobs/{}?wait={wait_s}&since={since}", encode(id)))
    }

    /// Jobs, the newest first.
    pub fn jobs(
        &self,
        dataset: Option<&str>,
        state: Option<&str>,
        limit: usize,
    ) -> Result<Vec<JobRow>, ClientError> {
        self.rows("/v1/jobs", &[("dataset", dataset), ("state", state)], limit)
    }

    /// Changes the state of a job.
    pub fn change_job(&self, id: &str, change: JobChange) -> Result<JobRow, ClientError> {
        self.post(&format!("/v1/jobs/{}/{}", encode(id), change.segment()), &[], b"")
    }

    /// The failed frames of a job.
    pub fn failed_frames(&self, id: &str) -> Result<Vec<FailureRow>, ClientError> {
        self.lines(&format!("/v1/jobs/{}/errors", encode(id)))
    }

    /// The warnings of a job's frames, the most frequent first.
    pub fn frame_warnings(&self, id: &str) -> Result<Vec<FrameWarning>, ClientError> {
        let page: Page<FrameWarning> = self.get(&format!("/v1/jobs/{}/warnings", encode(id)))?;
        Ok(page.items)
    }

    /// All datasets by name.
    pub fn datasets(&self) -> Result<Vec<DatasetRow>, ClientError> {
        self.rows("/v1/datasets", &[], usize::MAX)
    }

    /// The dataset or sealed version of a name.
    pub fn dataset(&self, name: &str) -> Result<Option<DatasetDetail>, ClientError> {
        self.find(&format!("/v1/datasets/{}", encode(name)))
    }

    /// Statistics of a dataset or sealed version.
    pub fn statistics(&self, dataset: &str, query: StatisticsQuery<'_>) -> Result<Statistics, ClientError> {
        let parameters = [
            ("metrics", Some(query.metrics)),
            ("group_by", Some(query.group_by)),
            ("by", Some(query.by)),
            ("filter", Some(query.filter)),
        ];
        self.get(&with_query(
            &format!("/v1/datasets/{}/stats", encode(dataset)),
            &parameters,
        ))
    }

    /// The sealed versions of a dataset; `None` without the dataset.
    pub fn versions(&self, dataset: &str) -> Result<Option<Vec<VersionRow>>, ClientError> {
        self.find_all(&format!("/v1/datasets/{}/versions", encode(dataset)))
    }

    /// Seals a dataset.
    pub fn seal(&self, dataset: &str) -> Result<VersionRow, ClientError> {
        self.post(&format!("/v1/datasets/{}/versions", encode(dataset)), &[], b"")
    }

    /// Verifies a sealed version; with `bytes`, also the bytes of its artifacts.
    pub fn verify(&self, dataset: &str, number: &str, bytes: bool) -> Result<VerifiedVersion, ClientError> {
        let path = format!("/v1/datasets/{}/versions/{number}/verify", encode(dataset));
        self.post(&path, &[], format!("{{\"bytes\":{bytes}}}").as_bytes())
    }

    /// Uploaded scenes, the newest first.
    pub fn scenes(&self, limit: usize) -> Result<Vec<SceneView>, ClientError> {
        self.rows("/v1/scenes", &[], limit)
    }

    /// The uploaded scene of an id.
    pub fn scene(&self, id: &str) -> Result<Option<SceneView>, ClientError> {
        self.find(&format!("/v1/scenes/{}", encode(id)))
    }

    /// All collections of scenes by name.
    pub fn collections(&self) -> Result<Vec<CollectionRow>, ClientError> {
        self.list("/v1/collections")
    }

    /// The scenes of a collection in their order; `None` without the collection.
    pub fn collection(&self, name: &str) -> Result<Option<Vec<CollectionScene>>, ClientError> {
        self.find_all(&format!("/v1/collections/{}", encode(name)))
    }

    /// Starts the import of a set.
    pub fn import_set(&self, url: &str) -> Result<SetView, ClientError> {
        let body = serde_json::json!({"url": url}).to_string();
        self.post("/v1/sets", &[], body.as_bytes())
    }

    /// The set of an imported job.
    pub fn set(&self, job: &str) -> Result<SetView, ClientError> {
        self.get(&format!("/v1/sets/{}", encode(job)))
    }

    /// Starts a backup of everything stored.
    pub fn back_up(&self) -> Result<BackupView, ClientError> {
        self.post("/v1/backups", &[], b"")
    }

    /// All rows of a list that has one page.
    pub fn list<T: DeserializeOwned>(&self, path: &str) -> Result<Vec<T>, ClientError> {
        let page = self.get::<Page<T>>(path)?;
        self.report_damage(&page.damaged);
        Ok(page.items)
    }

    fn find_all<T: DeserializeOwned>(&self, path: &str) -> Result<Option<Vec<T>>, ClientError> {
        Ok(self.find::<Page<T>>(path)?.map(|page| page.items))
    }
}
