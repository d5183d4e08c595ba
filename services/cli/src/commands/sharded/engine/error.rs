//! Errors of a broker.

/// A failed request to the broker, which may be unavailable or have lost its messages.
#[derive(Debug, thiserror::Error)]
#[error("the broker does not respond: {0}")]
pub(crate) struct BrokerError(pub(super) String);

impl BrokerError {
    pub(super) fn new(error: impl std::fmt::Display) -> Self {
        Self(error.to_string())
    }
}
