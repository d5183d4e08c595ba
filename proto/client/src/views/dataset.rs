//! Datasets and their columns.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A named, growing collection of images.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
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

/// A dataset with its columns.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct DatasetDetail {
    #[serde(flatten)]
    #[allow(missing_docs, reason = "its fields stand in its place")]
    pub dataset: DatasetRow,
    /// What is known of its images.
    pub columns: Vec<ColumnInfo>,
}

/// A column that filters, orders and tables may name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[schema(as = Column)]
pub struct ColumnInfo {
    /// Its name.
    #[schema(example = "camera.hfov_deg")]
    pub name: String,
    /// `number`, `text` or `bool`.
    pub kind: String,
    /// Its unit, where it has one.
    #[schema(example = "degree")]
    pub unit: Option<String>,
}
