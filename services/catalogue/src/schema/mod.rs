//! The schema of the database, and the backfill of new columns.

pub(crate) mod backfill;
pub(crate) mod migrations;
