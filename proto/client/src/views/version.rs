//! Sealed versions of datasets.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::time::UnixMs;

/// A sealed version of a dataset.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[schema(as = DatasetVersion)]
pub struct VersionRow {
    /// What it is called wherever a dataset is named.
    #[schema(example = "tour@1")]
    pub name: String,
    /// The dataset.
    #[schema(example = "tour")]
    pub dataset: String,
    /// Its number, from 1.
    pub version: u64,
    /// Root of the Merkle tree over the roots of its jobs, each that of a tree over the digests of its images.
    pub root: String,
    /// Number of images.
    pub images: u64,
    /// Bytes of their artifacts, counting shared ones each time.
    pub bytes: u64,
    /// Number of jobs.
    pub jobs: u64,
    /// Versions of the program that made the images.
    pub code_versions: Vec<String>,
    /// When it was sealed, RFC 3339 in UTC.
    #[schema(value_type = String, format = DateTime)]
    pub created_at: UnixMs,
}

/// Something about an image that is not as it was sealed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct DamagedImage {
    /// Its job.
    pub job: String,
    /// Its frame; null: the images of the job as a whole.
    pub frame: Option<u64>,
    /// What is wrong.
    pub reason: String,
}

/// What was found.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct VerifiedVersion {
    /// Whether everything is as it was sealed.
    pub intact: bool,
    /// The root that was sealed.
    pub root: String,
    /// The root that follows from the records of the images now.
    pub computed: String,
    /// Images whose records were read.
    pub images: u64,
    /// Artifacts whose bytes were read.
    pub artifacts: u64,
    /// Number of findings.
    pub damages: u64,
    /// The first 100 of them.
    pub damaged: Vec<DamagedImage>,
}
