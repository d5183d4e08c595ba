//! Work outside of the request threads: child processes, and the pool for what computes.

pub(crate) mod child;
pub(crate) mod compute;
pub(crate) mod decoding;
pub(crate) mod fleet;
pub(crate) mod live;

/// Where handlers send what takes long.
pub(crate) struct Processes {
    pub(crate) compute: compute::Compute,
    pub(crate) children: child::Children,
    pub(crate) decoding: decoding::Decoding,
    /// Absent where only others render.
    pub(crate) live: Option<live::Live>,
}
