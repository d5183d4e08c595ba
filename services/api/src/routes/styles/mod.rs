//! Style water models.

pub(crate) mod create;
pub(crate) mod list;
