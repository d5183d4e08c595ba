//! Failed requests.

use crate::http::{HttpError, Problem};

/// Why a request failed.
#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    /// No response, or one that broke off.
    #[error("no service responds at {base}: {source}; start one with `fathom serve`")]
    Unreachable {
        /// URL of the service.
        base: String,
        /// The error of the connection.
        source: ureq::Error,
    },
    /// The service refused.
    #[error("{}", .0.message())]
    Refused(Problem),
    /// A response of success that is not of the expected form.
    #[error("the response to {path} is not of the expected form")]
    Unreadable {
        /// The path of the request.
        path: String,
        /// The error of the parser.
        source: serde_json::Error,
    },
}

impl ClientError {
    pub(crate) fn new(base: &str, error: HttpError) -> Self {
        match error {
            HttpError::Unreachable(source) => Self::Unreachable {
                base: base.to_owned(),
                source,
            },
            HttpError::Problem(problem) => Self::Refused(problem),
        }
    }

    /// Whether the path is unknown to the service.
    #[must_use]
    pub fn is_not_found(&self) -> bool {
        matches!(self, Self::Refused(problem) if problem.status.as_u16() == 404)
    }
}
