//! Datasets: their columns and their sealed versions.

pub(crate) mod columns;
pub(crate) mod seal;
pub(crate) mod versions;
