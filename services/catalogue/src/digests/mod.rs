//! Digests of rows, which reveal damage when a row is read.

pub(crate) mod record_row;
pub(crate) mod row_digests;
pub(crate) mod tables;
