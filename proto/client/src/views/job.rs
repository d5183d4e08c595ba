//! Jobs.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

use super::job_state::JobState;
use super::price::{Estimate, Price};
use super::time::UnixMs;

/// A job: one submitted description and how far its frames are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Job)]
pub struct JobRow {
    /// `job_` and a UUID.
    #[schema(example = "job_0198c0ffee007000800000000000000a")]
    pub id: String,
    /// The dataset that its images join.
    #[schema(example = "shaft-v1")]
    pub dataset: String,
    /// How far it is.
    #[schema(example = "running")]
    pub state: JobState,
    /// Number of frames.
    pub frames: u64,
    /// Frames whose image is stored.
    pub done: u64,
    /// Frames that were given up.
    pub failed: u64,
    /// Bytes of its artifacts, counting shared ones each time.
    pub bytes: u64,
    /// Grows with every change; pass it as `since` to wait for the next one.
    pub version: u64,
    /// When it was accepted, RFC 3339 in UTC.
    #[schema(value_type = String, format = DateTime)]
    pub created_at: UnixMs,
    /// When its first frame was stored or given up.
    #[schema(value_type = Option<String>, format = DateTime)]
    pub started_at: Option<UnixMs>,
    /// When its last frame was.
    #[schema(value_type = Option<String>, format = DateTime)]
    pub finished_at: Option<UnixMs>,
    /// SHA-256 over all frames' parameters and artifacts, once the job is done.
    pub digest: Option<String>,
    /// Folder or URL of the set that its images are imported from; absent: they are rendered for this service.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub set: Option<String>,
    /// What the user should know, though nothing is wrong. Only in the answer to the submission.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub warnings: Vec<String>,
    /// Expected cost; absent for imported jobs and those of earlier versions.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub price: Option<Price>,
    /// The caller that submitted it. Known to the service alone.
    #[serde(skip)]
    pub owner: Option<String>,
    /// Frames from workers outside of the service without a good check after them. Of an ended job: frames that no check
    /// could prove.
    #[serde(default)]
    pub unproven: u64,
    /// Whether its frames may come from workers of any version and kind of machine; absent: no.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub mixed: bool,
    /// Whether a check found a wrong frame, so that every frame from outside is checked. Known to the service alone.
    #[serde(skip)]
    pub distrusted: bool,
    /// Higher goes first. Known to the service alone.
    #[serde(skip)]
    pub priority: i32,
    /// SHA-256 of its canonical description. Known to the service alone.
    #[serde(skip)]
    pub spec_digest: String,
}

impl JobRow {
    /// Whether services share the job: its set is named by its id, and a change of it is one of the set.
    #[must_use]
    pub fn is_shared(&self) -> bool {
        let named = self.set.as_deref().and_then(|set| set.rsplit_once('/'));
        named.is_some_and(|(_, name)| name == self.id)
    }
}

/// A frame that failed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FailureRow {
    /// The frame.
    pub frame: u64,
    /// Attempts that count against it.
    pub strikes: u32,
    /// Whether it was given up; otherwise it is tried again.
    #[serde(rename = "given_up")]
    pub quarantined: bool,
    /// The error of the last attempt.
    pub error: String,
}

/// A warning about frames of a job.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct FrameWarning {
    /// Its text.
    #[schema(example = "no pixel has a valid range")]
    pub warning: String,
    /// Number of frames with it.
    pub frames: u64,
    /// The first of them.
    pub first_frame: u64,
}

/// A frame with all distributions drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ResolvedFrame {
    /// Frame number.
    pub frame: u64,
    /// Its description.
    #[schema(value_type = Object)]
    pub parameters: Value,
}

/// A job that was not submitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct JobPreview {
    /// Number of frames.
    pub frames: u64,
    /// The first frames.
    pub first: Vec<ResolvedFrame>,
    /// Warnings about the valid description.
    pub warnings: Vec<String>,
    /// Estimated cost.
    pub estimate: Estimate,
}

/// What is gone.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Deleted {
    /// Jobs.
    pub jobs: u64,
    /// Images.
    pub images: u64,
    /// Bytes of their artifacts, counting shared ones each time. What nothing else uses comes back within minutes.
    pub bytes: u64,
}
