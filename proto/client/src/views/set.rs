//! Imported sets.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::job_state::JobState;
use super::time::UnixMs;

/// A set whose images are imported into a job of their own.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[schema(as = Set)]
pub struct SetView {
    /// The job that its images belong to. It is also what names the set.
    #[schema(example = "job_0198c0ffee007000800000000000000a")]
    pub job: String,
    /// Where it lies.
    #[schema(example = "s3://reef/tour")]
    pub url: String,
    /// The dataset that its images join.
    #[schema(example = "shaft-v1")]
    pub dataset: String,
    /// How far the job is: frames are counted when their shard is imported.
    pub state: JobState,
    /// Number of frames.
    pub frames: u64,
    /// Frames whose image is imported.
    pub done: u64,
    /// Frames that have no image.
    pub failed: u64,
    /// Shards that are imported.
    pub shards: u64,
    /// Whether the service looks for further shards. It does until every frame has ended.
    pub followed: bool,
    /// When it looked last; null: not since it was started.
    #[schema(value_type = Option<String>, format = DateTime)]
    pub looked_at: Option<UnixMs>,
    /// Why that look ended early; null: it did not.
    pub error: Option<String>,
}
