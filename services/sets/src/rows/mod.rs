//! The rows of shards: writing, reading and checking them.

pub(crate) mod cells;
pub(crate) mod columns;
pub(crate) mod digests;
pub(crate) mod group;
pub(crate) mod reading;
pub(crate) mod rows_file;
pub(crate) mod table;
