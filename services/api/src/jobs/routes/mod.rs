//! Jobs.

pub(crate) mod control;
pub(crate) mod create;
pub(crate) mod description;
pub(crate) mod events;
pub(crate) mod get;
pub(crate) mod lines;
pub(crate) mod list;
pub(crate) mod preview;
pub(crate) mod render;
