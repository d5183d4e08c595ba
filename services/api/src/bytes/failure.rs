//! Tracks whether the disk refuses writes.

use std::sync::{Mutex, PoisonError};

/// The reason of the last failed write, until writes work again.
#[derive(Default)]
pub(crate) struct WriteFailure(Mutex<Option<String>>);

impl WriteFailure {
    pub(crate) fn note(&self, reason: &str) {
        self.set(Some(reason.to_owned()));
    }

    pub(super) fn set(&self, reason: Option<String>) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = reason;
    }

    pub(super) fn reason(&self) -> Option<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}
