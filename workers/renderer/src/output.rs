//! Files and records of a frame.

pub(crate) mod file;
pub(crate) mod provenance;
pub(crate) mod record;
