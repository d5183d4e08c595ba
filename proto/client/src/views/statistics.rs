//! Statistics of datasets.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

/// All groups.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Statistics {
    /// The columns of `by`; absent without it.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[schema(nullable = false)]
    pub by: Option<Vec<GroupColumn>>,
    /// One entry for each group and metric.
    pub groups: Vec<GroupStats>,
    /// Where the images were read.
    pub source: CountedSource,
}

/// A column by which images are grouped.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct GroupColumn {
    /// The column.
    #[schema(example = "alpha")]
    pub column: String,
    /// Its unit, where it has one.
    pub unit: Option<String>,
    /// Width of its bins; null: each value is a group.
    #[schema(example = 0.1)]
    pub width: Option<f64>,
}

/// Statistics of a metric in a group of images.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
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

/// Where the images that were counted were read.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct CountedSource {
    /// Images that were read from the mirror, by columns.
    pub mirror: u64,
    /// Images that were read from the catalogue, row by row.
    pub catalogue: u64,
}
