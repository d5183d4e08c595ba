//! Counts of rendered shards.

use std::time::Instant;

/// The counts of this call.
pub(crate) struct Tally {
    pub(super) begun: Instant,
    pub(super) frames: u64,
    pub(super) shards: usize,
}
