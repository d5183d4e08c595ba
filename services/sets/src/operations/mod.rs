//! Operations on whole sets, and stores with several of them.

pub(crate) mod jobs;
pub(crate) mod listing;
pub(crate) mod plan;
pub(crate) mod rerender;
pub(crate) mod seal;
pub(crate) mod verify;
pub(crate) mod watch;
