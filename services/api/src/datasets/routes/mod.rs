//! Datasets.

pub(crate) mod dataset;
pub(crate) mod histogram;
pub(crate) mod metadata;
pub(crate) mod stats;
