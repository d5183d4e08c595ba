//! Work outside of the request threads: child processes, and the pool for what computes.

pub(crate) mod child;
pub(crate) mod compute;
pub(crate) mod fleet;
