//! Rendering and committing shards.

pub(crate) mod archive;
pub(crate) mod draft;
pub(crate) mod shard;
