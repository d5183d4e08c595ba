//! Lists, shell completions and manual pages.

pub(crate) mod completions;
pub(crate) mod list;
pub(crate) mod topics;
