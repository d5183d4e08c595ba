//! Lists, shell completions and manual pages.

pub(crate) mod completions;
pub(crate) mod list;
#[cfg(test)]
mod page;
pub(crate) mod topics;
