//! Rows and queries.

use std::collections::BTreeMap;
use std::ops::Range;

use client::{CountedSource, FailureRow, JobRow, Price, UnixMs};
use serde::{Deserialize, Serialize};
use spec::{ArtifactEntry, Provenance, SceneFiles};
use utoipa::ToSchema;

use crate::image_id::ImageId;

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
    /// The key under which a repeated submission returns this job.
    pub idempotency: Option<Idempotency>,
    /// Folder or URL of the set that its images are imported from; a repeat finds this job by it.
    pub set: Option<String>,
    /// Who is charged for it; `None` for imported jobs.
    pub charge: Option<Charge>,
    /// Whether it is stored although its dataset has every image of the same description.
    pub again: bool,
}

/// The caller of a job, and its expected cost.
#[derive(Debug, Clone)]
pub struct Charge {
    /// The caller.
    pub owner: String,
    /// The expected cost.
    pub price: Price,
}

/// A key under which a repeated submission returns its job.
#[derive(Debug, Clone)]
pub struct Idempotency {
    /// Whose key it is.
    pub owner: String,
    /// The key.
    pub key: String,
    /// Digest of the description.
    pub body_digest: String,
}

/// The result of a submission.
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

/// A job that has not ended, with the state of its frames.
#[derive(Debug, Clone)]
pub struct OpenJob {
    /// The job.
    pub row: JobRow,
    /// Frames with an image.
    pub done: Vec<Range<u64>>,
    /// Abandoned frames.
    pub failed: Vec<u64>,
    /// Strikes of frames that are still tried.
    pub strikes: BTreeMap<u64, u32>,
    /// Provenance of its first image.
    pub provenance: Option<Provenance>,
}

impl From<JobRow> for OpenJob {
    /// A job without finished frames.
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
    /// The image that it belongs to.
    pub image: ImageId,
    /// Kind, digest, length and type.
    pub entry: ArtifactEntry,
    /// The place of the bytes in a set; `None`: in the packs.
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
    /// Completes the shard; `None`: more images follow.
    pub end: Option<ShardEnd>,
}

/// The end of a shard's import.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShardEnd {
    /// Digest over its images.
    pub digest: String,
    /// When its marker was written, by the clock of the store.
    pub changed_ms: i64,
    /// Frames without an image.
    pub failed: Vec<FailureRow>,
}

/// A completely imported shard.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ImportedShard {
    /// Its first frame.
    pub frame: u64,
    /// Digest over its images.
    pub digest: String,
    /// When its marker was written, by the clock of the store.
    pub changed_ms: i64,
}

/// The result of a commit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InsertImage {
    /// The image is stored.
    Inserted,
    /// The frame already has an image.
    AlreadyThere,
}

/// Who rendered a frame, if the service does not trust it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Delivery {
    /// Id of the worker's registration.
    pub worker: String,
    /// Order of commits: larger than that of every earlier delivery.
    pub place: u64,
    /// Whether the frame was drawn to be rendered again.
    pub is_due: bool,
}

/// A frame to be rendered again and compared.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct DueCheck {
    /// Its job.
    pub job: String,
    /// The frame.
    pub frame: u64,
    /// Id of the registration of the worker that rendered it.
    pub worker: String,
}

/// The state of a job whose frames have all ended.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Settled {
    /// Frames drawn to be checked before it can end.
    pub checks: Vec<DueCheck>,
    /// Whether it has ended, now or before.
    pub has_ended: bool,
}

/// A query for a page of images.
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
    pub source: CountedSource,
}

/// An uploaded scene.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneRow {
    /// `scn_…`.
    pub id: String,
    /// Digest over everything that a render depends on.
    pub content_digest: String,
    /// Digests and meaning of the files.
    pub files: SceneFiles<String>,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// When it was stored.
    pub created_at: UnixMs,
}

/// Records of a job in frame order.
#[derive(Debug, Clone, Default)]
pub struct FrameRows {
    /// The records.
    pub rows: Vec<serde_json::Value>,
    /// Damaged rows, which are left out.
    pub damaged: Vec<String>,
    /// The frame after which the next rows start, if there may be any.
    pub next: Option<u64>,
}
