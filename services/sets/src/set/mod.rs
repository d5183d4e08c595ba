//! A set: its job, its state and its markers.

pub(crate) mod job;
pub(crate) mod marker;
pub(crate) mod opened;
pub(crate) mod state;
