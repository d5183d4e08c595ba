//! Child processes that render frames, and their supervisor.

pub(crate) mod child;
pub(crate) mod crew;
pub(crate) mod message;
pub(crate) mod open;
