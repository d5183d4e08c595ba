//! Why work on a set ends early.

/// Why work on a set ends early; the variants differ in how the caller should react.
#[derive(Debug, thiserror::Error)]
pub enum SetError {
    /// Invalid input; repeating the call changes nothing.
    #[error("{0}")]
    Refused(String),
    /// The store does not respond, is full, or is not to be worked on now; the same call may succeed later.
    #[error("{0}")]
    Later(String),
    /// Stored bytes contradict each other.
    #[error("{0}")]
    Damaged(String),
    /// This machine cannot do the work.
    #[error("{0}")]
    Machine(String),
}

impl SetError {
    /// The error for an object that contradicts others.
    pub(crate) fn damaged(name: &str, reason: impl std::fmt::Display) -> Self {
        Self::Damaged(format!("{name}: {reason}"))
    }

    /// The error for an object with unreadable content.
    pub(crate) fn unreadable(name: &str, reason: impl std::fmt::Display) -> Self {
        Self::Damaged(format!("{name} cannot be read: {reason}"))
    }
}
