//! A job as clients see it.

use catalogue::JobRow;
use serde::Serialize;
use utoipa::ToSchema;

use crate::http::time::rfc3339;

/// A job: one submitted description and how far its frames are.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Job)]
pub(crate) struct JobView {
    /// `job_` and a UUID.
    #[schema(example = "job_0198c0ffee007000800000000000000a")]
    id: String,
    /// The dataset that its images join.
    #[schema(example = "shaft-v1")]
    dataset: String,
    /// `queued`, `running`, `paused`, `cancelled`, `done` or `done_with_failures`.
    #[schema(example = "running")]
    state: String,
    /// Number of frames.
    frames: u64,
    /// Frames whose image is stored.
    done: u64,
    /// Frames that were given up.
    failed: u64,
    /// Bytes of its artifacts, counting shared ones each time.
    bytes: u64,
    /// Grows with every change; pass it as `since` to wait for the next one.
    version: u64,
    /// When it was accepted, RFC 3339 in UTC.
    created_at: String,
    /// When its first frame was stored or given up.
    started_at: Option<String>,
    /// When its last frame was.
    finished_at: Option<String>,
    /// SHA-256 over all frames' parameters and artifacts, once the job is done.
    digest: Option<String>,
    /// What the user should know, though nothing is wrong. Only in the answer to the submission.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    warnings: Vec<String>,
}

impl JobView {
    pub(crate) fn new(row: JobRow, warnings: &[String]) -> Self {
        Self {
            id: row.id,
            dataset: row.dataset,
            state: row.state.to_string(),
            frames: row.frames,
            done: row.done,
            failed: row.failed,
            bytes: row.bytes,
            version: row.version,
            created_at: rfc3339(row.created_ms),
            started_at: row.started_ms.map(rfc3339),
            finished_at: row.finished_ms.map(rfc3339),
            digest: row.digest,
            warnings: warnings.to_vec(),
        }
    }
}

impl From<JobRow> for JobView {
    fn from(row: JobRow) -> Self {
        Self::new(row, &[])
    }
}
