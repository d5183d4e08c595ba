//! Datasets and scenes of a service, and sets.

pub(crate) mod datasets;
pub(crate) mod export;
pub(crate) mod import;
pub(crate) mod query;
pub(crate) mod recording;
pub(crate) mod rm;
pub(crate) mod scenes;
pub(crate) mod seal;
pub(crate) mod sheet;
pub(crate) mod stats;
pub(crate) mod upload;
pub(crate) mod verify;
