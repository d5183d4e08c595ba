//! Rows and questions. What clients see of a row is the row itself, serialized.

use std::collections::BTreeMap;
use std::ops::Range;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use spec::{ArtifactEntry, Provenance, SceneFiles};
use utoipa::ToSchema;

use crate::job_state::JobState;
use crate::source::Source;
use crate::time::UnixMs;

/// A job to store.
#[derive(Debug, Clone)]
pub struct NewJob {
    /// `job_…`.
    pub id: String,
    /// The dataset that its images join.
    pub dataset: String,
    /// Canonical description.
    pub spec: String,
    /// Its SHA-256.
    pub spec_digest: String,
    /// Number of frames.
    pub frames: u64,
    /// Higher goes first.
    pub priority: i32,
    /// Now.
    pub created_at: UnixMs,
    /// The key under which a repeat finds this job.
    pub idempotency: Option<Idempotency>,
    /// Folder or URL of the set that its images are imported from; a repeat finds this job by it.
    pub set: Option<String>,
    /// Whether it is stored although its dataset has every image of the same description.
    pub again: bool,
}

/// A key under which a repeated submission finds its job.
#[derive(Debug, Clone)]
pub struct Idempotency {
    /// Whose key it is.
    pub owner: String,
    /// The key.
    pub key: String,
    /// Digest of the description.
    pub body_digest: String,
}

/// What became of a submission.
#[derive(Debug, Clone, PartialEq)]
pub enum InsertJob {
    /// It is stored, as this row.
    Created(JobRow),
    /// The same submission was stored before; the job as it is now.
    Replayed(JobRow),
    /// The dataset has every image of the same description, from this job; no job is stored.
    Complete(JobRow),
    /// The key was used for another description.
    KeyConflict,
}

/// A job: one submitted description and how far its frames are.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
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
    #[serde(skip_serializing_if = "Option::is_none")]
    pub set: Option<String>,
    /// What the user should know, though nothing is wrong. Only in the answer to the submission.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// Higher goes first.
    #[serde(skip)]
    pub priority: i32,
    /// SHA-256 of its canonical description.
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

/// A job that has not ended, with what is left of it.
#[derive(Debug, Clone)]
pub struct OpenJob {
    /// The job.
    pub row: JobRow,
    /// Frames with an image.
    pub done: Vec<Range<u64>>,
    /// Frames that were given up.
    pub failed: Vec<u64>,
    /// Strikes of frames that are still tried.
    pub strikes: BTreeMap<u64, u32>,
    /// What its first image was made with.
    pub provenance: Option<Provenance>,
}

impl From<JobRow> for OpenJob {
    /// A job of which no frame has ended.
    fn from(row: JobRow) -> Self {
        Self {
            row,
            done: Vec::new(),
            failed: Vec::new(),
            strikes: BTreeMap::new(),
            provenance: None,
        }
    }
}

/// A job whose failed frames are tried again.
#[derive(Debug, Clone, PartialEq)]
pub struct Retried {
    /// The job as it is now.
    pub job: JobRow,
    /// The frames that had been given up.
    pub frames: Vec<u64>,
}

/// What is gone.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, ToSchema)]
pub struct Deleted {
    /// Jobs.
    pub jobs: u64,
    /// Images.
    pub images: u64,
    /// Bytes of their artifacts, counting shared ones each time. What nothing else uses comes back within minutes.
    pub bytes: u64,
}

/// A digest with one of the rows that name it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedDigest {
    /// SHA-256 of the bytes.
    pub digest: String,
    /// A job.
    pub job_id: String,
    /// A frame of it.
    pub frame: u64,
    /// The kind of artifact.
    pub kind: String,
    /// Length of the bytes.
    pub bytes: u64,
}

/// An artifact, and where its bytes are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredArtifact {
    /// Kind, digest, length and type.
    pub entry: ArtifactEntry,
    /// Where the bytes lie in a set; `None`: in the packs.
    pub place: Option<Place>,
}

/// Where the bytes of an imported artifact begin.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Folder or URL of the set.
    pub set: String,
    /// Name of the tar below it.
    pub tar: String,
    /// Bytes of the tar before those of the artifact.
    pub offset: u64,
}

/// An imported artifact.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ImportedArtifact {
    /// Its job.
    pub job_id: String,
    /// Its frame.
    pub frame: u64,
    /// Kind, digest, length and type.
    pub entry: ArtifactEntry,
    /// Where its bytes are.
    pub place: Place,
}

/// A shard of a set on its way in.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct NewShard {
    /// Its first frame.
    pub frame: u64,
    /// Name of its tar below the set.
    pub tar: String,
    /// What completes it; `None`: more images follow.
    pub end: Option<ShardEnd>,
}

/// What completes the import of a shard.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShardEnd {
    /// Digest over its images.
    pub digest: String,
    /// When its marker was written, by the clock of the store.
    pub changed_ms: i64,
    /// Frames without an image.
    pub failed: Vec<FailureRow>,
}

/// A shard that is imported as a whole.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ImportedShard {
    /// Its first frame.
    pub frame: u64,
    /// Digest over its images.
    pub digest: String,
    /// When its marker was written, by the clock of the store.
    pub changed_ms: i64,
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
    /// What the last attempt said.
    pub error: String,
}

/// What became of a commit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InsertImage {
    /// The image is stored.
    Inserted,
    /// The frame has an image already; nothing changed.
    AlreadyThere,
}

/// A question for a page of images.
#[derive(Debug, Clone, Default)]
pub struct ImageQuery {
    /// Only this dataset.
    pub dataset: Option<String>,
    /// Only images that fulfill this.
    pub filter: Option<String>,
    /// A column, with `-` before it the largest first; absent: by job and frame.
    pub order_by: Option<String>,
    /// Rows of the page.
    pub limit: u32,
    /// Where the page before ended.
    pub cursor: Option<String>,
    /// Rows before the page; not together with a cursor.
    pub offset: u64,
    /// Columns; empty: all that have a value.
    pub fields: Vec<String>,
}

/// A page of a list.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Page<T> {
    /// The rows.
    pub items: Vec<T>,
    /// Pass it as `cursor` for the next page; null: this is the last one.
    pub next_cursor: Option<String>,
}

impl<T> Page<T> {
    /// All rows on one page.
    pub fn whole(items: Vec<T>) -> Self {
        Self {
            items,
            next_cursor: None,
        }
    }
}

/// Statistics of a metric in a group of images.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = GroupStatistics)]
pub struct GroupStats {
    /// Value of the `group_by` column; null without one. With `by`, an object with the value of each column, of a column in
    /// bins the lower edge of the bin, which holds edge ≤ value < edge + width.
    pub group: Value,
    /// The metric.
    pub metric: String,
    /// Images that have a value.
    pub count: u64,
    /// Their mean.
    pub mean: Option<f64>,
    /// Their standard deviation.
    pub sd: Option<f64>,
    /// The smallest value.
    pub min: Option<f64>,
    /// A quarter of the values is below.
    pub q25: Option<f64>,
    /// Half of them is below.
    pub median: Option<f64>,
    /// Three quarters are below.
    pub q75: Option<f64>,
    /// The largest value.
    pub max: Option<f64>,
}

/// How the values of a column are spread.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Histogram {
    /// The column.
    pub column: String,
    /// Edges of the bins, one more than bins. The first edge of a bin belongs to it; the last bin has both.
    pub edges: Vec<f64>,
    /// Values in each bin.
    pub counts: Vec<u64>,
    /// Values below the first edge.
    pub below: u64,
    /// Values above the last edge.
    pub above: u64,
    /// Images without a value.
    pub missing: u64,
    /// Where the images were read.
    pub source: Source,
}

/// A column that filters, orders and tables may name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[schema(as = Column)]
pub struct ColumnInfo {
    /// Its name.
    #[schema(example = "camera.hfov_deg")]
    pub name: String,
    /// `number`, `text` or `bool`.
    pub kind: &'static str,
    /// Its unit, where it has one.
    #[schema(example = "degree")]
    pub unit: Option<&'static str>,
}

/// A named, growing collection of images.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[schema(as = Dataset)]
pub struct DatasetRow {
    /// Its name.
    pub name: String,
    /// Number of images.
    pub images: u64,
    /// Bytes of their artifacts, counting shared ones each time.
    pub bytes: u64,
    /// Number of jobs.
    pub jobs: u64,
}

/// An uploaded scene.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneRow {
    /// `scn_…`.
    pub id: String,
    /// Digest over everything that a render depends on.
    pub content_digest: String,
    /// Digests of the files, and what they mean.
    pub files: SceneFiles<String>,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// When it was stored.
    pub created_at: UnixMs,
}
