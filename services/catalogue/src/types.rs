//! Rows and questions. Times are Unix milliseconds.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use serde_json::Value;
use spec::SceneFiles;

/// Where a job stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JobState {
    /// No frame has ended yet.
    Queued,
    /// Some frames have ended.
    Running,
    /// Nothing is offered for now.
    Paused,
    /// Stopped by the user; what is there stays.
    Cancelled,
    /// Every frame has its image.
    Done,
    /// Every frame has ended, some without an image.
    DoneWithFailures,
}

impl JobState {
    const ALL: [(Self, &'static str); 6] = [
        (Self::Queued, "queued"),
        (Self::Running, "running"),
        (Self::Paused, "paused"),
        (Self::Cancelled, "cancelled"),
        (Self::Done, "done"),
        (Self::DoneWithFailures, "done_with_failures"),
    ];

    /// The names, in order.
    #[must_use]
    pub fn names() -> [&'static str; 6] {
        Self::ALL.map(|(_, name)| name)
    }

    /// Whether nothing more will happen to the job.
    #[must_use]
    pub fn has_ended(self) -> bool {
        matches!(self, Self::Cancelled | Self::Done | Self::DoneWithFailures)
    }
}

impl fmt::Display for JobState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            Self::ALL
                .iter()
                .find(|(state, _)| state == self)
                .map_or("", |(_, name)| name),
        )
    }
}

impl FromStr for JobState {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let known = Self::ALL.iter().find(|(_, known)| *known == name);
        known
            .map(|(state, _)| *state)
            .ok_or_else(|| format!("`{name}` is no state; there are {}", Self::names().join(", ")))
    }
}

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
    pub created_ms: u64,
    /// The key under which a repeat finds this job.
    pub idempotency: Option<Idempotency>,
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
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum InsertJob {
    /// It is stored.
    Created,
    /// The same submission was stored before.
    Replayed {
        /// As this job.
        job_id: String,
    },
    /// The key was used for another description.
    KeyConflict,
}

/// A stored job.
#[derive(Debug, Clone, PartialEq)]
pub struct JobRow {
    /// `job_…`.
    pub id: String,
    /// The dataset that its images join.
    pub dataset: String,
    /// Canonical description.
    pub spec: String,
    /// Number of frames.
    pub frames: u64,
    /// Frames with an image.
    pub done: u64,
    /// Frames that were given up.
    pub failed: u64,
    /// Bytes of its artifacts, shared ones counted each time.
    pub bytes: u64,
    /// Where it stands.
    pub state: JobState,
    /// Grows with every change.
    pub version: u64,
    /// Higher goes first.
    pub priority: i32,
    /// When it was stored.
    pub created_ms: u64,
    /// When its first frame ended.
    pub started_ms: Option<u64>,
    /// When its last frame ended.
    pub finished_ms: Option<u64>,
    /// Over all frames, once it is done.
    pub digest: Option<String>,
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
}

/// A job whose failed frames are tried again.
#[derive(Debug, Clone, PartialEq)]
pub struct Retried {
    /// The job as it is now.
    pub job: JobRow,
    /// The frames that had been given up.
    pub frames: Vec<u64>,
}

/// What a deletion took away.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Deleted {
    /// Jobs.
    pub jobs: u64,
    /// Images.
    pub images: u64,
    /// Bytes of their artifacts, shared ones counted each time.
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

/// A frame that failed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FailureRow {
    /// The frame.
    pub frame: u64,
    /// How often.
    pub strikes: u32,
    /// Whether it was given up.
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

/// A stored image.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageRow {
    /// The job.
    pub job_id: String,
    /// The dataset.
    pub dataset: String,
    /// When it was stored.
    pub created_ms: u64,
    /// The whole record.
    pub record: Value,
}

/// A question for a page of images.
#[derive(Debug, Clone, Default)]
pub struct ImageQuery {
    /// Only this dataset.
    pub dataset: Option<String>,
    /// Only images that fulfil this.
    pub filter: Option<String>,
    /// A column, with `-` before it the largest first; absent: by job and frame.
    pub order_by: Option<String>,
    /// Rows of the page.
    pub limit: u32,
    /// Where the page before ended.
    pub cursor: Option<String>,
    /// Columns; empty: all that have a value.
    pub fields: Vec<String>,
}

/// A page of a list.
#[derive(Debug, Clone, PartialEq)]
pub struct Page<T> {
    /// The rows.
    pub items: Vec<T>,
    /// Where the next page begins; none: this is the last.
    pub next_cursor: Option<String>,
}

/// Statistics of one metric in one group.
#[derive(Debug, Clone, PartialEq)]
pub struct GroupStats {
    /// Value of the grouping column.
    pub group: Value,
    /// The metric.
    pub metric: String,
    /// Images that have a value.
    pub count: u64,
    /// Their mean.
    pub mean: Option<f64>,
    /// Their sample standard deviation; none for fewer than two.
    pub sd: Option<f64>,
    /// The smallest value.
    pub min: Option<f64>,
    /// Lower quartile, linear between neighbours.
    pub q25: Option<f64>,
    /// Median.
    pub median: Option<f64>,
    /// Upper quartile.
    pub q75: Option<f64>,
    /// The largest value.
    pub max: Option<f64>,
}

/// Values of a column in bins.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// The column.
    pub column: String,
    /// One more than bins.
    pub edges: Vec<f64>,
    /// Values of each bin.
    pub counts: Vec<u64>,
    /// Values below the first edge.
    pub below: u64,
    /// Values above the last edge.
    pub above: u64,
    /// Images without a value.
    pub missing: u64,
}

/// A column that images can be asked for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColumnInfo {
    /// Its name in filters, orders and rows.
    pub name: String,
    /// `number`, `text` or `bool`.
    pub kind: &'static str,
    /// Such as `1/m`, where it has one.
    pub unit: Option<&'static str>,
}

/// A dataset with its sums.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DatasetRow {
    /// Its name.
    pub name: String,
    /// Images.
    pub images: u64,
    /// Bytes of their artifacts, shared ones counted each time.
    pub bytes: u64,
    /// Jobs.
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
    pub created_ms: u64,
}

/// Rows of every table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Counts {
    /// Jobs.
    pub jobs: u64,
    /// Images.
    pub images: u64,
    /// Measured pictures.
    pub measurements: u64,
    /// Artifact names.
    pub artifacts: u64,
    /// Scenes.
    pub scenes: u64,
    /// Failed frames.
    pub failures: u64,
    /// Idempotency keys.
    pub idempotency_keys: u64,
    /// Jobs whose rows still have to go.
    pub deletions: u64,
    /// Digests whose bytes may have to go.
    pub orphans: u64,
}
