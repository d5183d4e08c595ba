//! A followed set, and the result of its last poll.

use std::sync::{Mutex, MutexGuard, PoisonError};

use catalogue::UnixMs;
use tokio::sync::Notify;
use tokio_util::sync::CancellationToken;

/// A followed set.
#[derive(Default)]
pub(crate) struct Followed {
    pub(super) last: Mutex<Last>,
    pub(super) wake: Notify,
    /// Cancelled when its job is deleted.
    pub(super) stop: CancellationToken,
}

/// Result of the last poll.
#[derive(Debug, Clone, Default)]
pub(crate) struct Last {
    /// Whether another poll will follow.
    pub(crate) goes_on: bool,
    pub(crate) at: Option<UnixMs>,
    pub(crate) error: Option<String>,
}

impl Followed {
    pub(crate) fn last(&self) -> MutexGuard<'_, Last> {
        self.last.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
