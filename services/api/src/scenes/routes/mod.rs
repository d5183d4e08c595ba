//! Uploaded scenes.

pub(crate) mod create;
pub(crate) mod files;
pub(crate) mod list;
