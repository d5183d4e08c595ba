//! Digests of rows, by which damage is found when a row is read.

pub(crate) mod record_row;
pub(crate) mod row_digests;
pub(crate) mod tables;
