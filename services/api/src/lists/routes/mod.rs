//! The lists of identifiers.

pub(crate) mod get;
pub(crate) mod list;
