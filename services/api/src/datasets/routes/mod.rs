//! Datasets.

pub(crate) mod delete;
pub(crate) mod get;
pub(crate) mod histogram;
pub(crate) mod list;
pub(crate) mod metadata;
pub(crate) mod stats;
