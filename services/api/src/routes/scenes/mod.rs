//! Uploaded scenes.

pub(crate) mod create;
pub(crate) mod list;
pub(crate) mod view;
