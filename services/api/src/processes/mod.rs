//! Work outside the request threads: child processes, and the computation pool.

use std::sync::Arc;

pub(crate) mod child;
pub(crate) mod compute;
pub(crate) mod decoding;
pub(crate) mod fleet;
pub(crate) mod lasting;
pub(crate) mod live;
pub(crate) mod pictures;
pub(crate) mod scratch;
pub(crate) mod turns;

/// Executors for long work.
pub(crate) struct Processes {
    pub(crate) compute: compute::Compute,
    pub(crate) children: child::Children,
    pub(crate) scratch: Arc<scratch::Scratch>,
    pub(crate) decoding: decoding::Decoding,
    /// Absent if only others render.
    pub(crate) live: Option<live::Live>,
    /// Absent if only others render.
    pub(crate) pictures: Option<pictures::PictureProcess>,
}
