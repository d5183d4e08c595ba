//! Style water models.

pub(crate) mod list;
