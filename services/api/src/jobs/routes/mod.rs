//! Jobs.

pub(crate) mod cancel;
pub(crate) mod create;
pub(crate) mod delete;
pub(crate) mod description;
pub(crate) mod errors;
pub(crate) mod events;
pub(crate) mod get;
pub(crate) mod list;
pub(crate) mod pause;
pub(crate) mod preview;
pub(crate) mod render;
pub(crate) mod results;
pub(crate) mod resume;
pub(crate) mod retry_failed;
