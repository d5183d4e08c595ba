//! Writes an export: its parts, shards and documents.

pub(crate) mod documents;
pub(crate) mod part;
pub(crate) mod recordings;
pub(crate) mod shards;
pub(crate) mod work;
