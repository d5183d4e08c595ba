//! Where what is counted comes from.

use serde::Serialize;
use utoipa::ToSchema;

/// Where the images that were counted were read.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, ToSchema)]
#[schema(as = CountedSource)]
pub struct Source {
    /// Images that were read from the mirror, by columns.
    pub mirror: u64,
    /// Images that were read from the catalogue, row by row.
    pub catalogue: u64,
}

impl From<columnar::Source> for Source {
    fn from(source: columnar::Source) -> Self {
        Self {
            mirror: source.files,
            catalogue: source.memory,
        }
    }
}
