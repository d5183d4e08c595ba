//! Datasets.

pub(crate) mod list;
pub(crate) mod stats;
