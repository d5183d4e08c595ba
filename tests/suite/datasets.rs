//! Datasets: exports, imports, versions and shards.

pub(crate) mod cluster;
pub(crate) mod export;
pub(crate) mod follow;
pub(crate) mod formats;
pub(crate) mod hostile_sets;
pub(crate) mod import;
pub(crate) mod in_and_out;
pub(crate) mod manage;
pub(crate) mod sets;
pub(crate) mod verify;
