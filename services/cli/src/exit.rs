//! Failures of commands and their exit statuses.

use client::{ClientError, Problem};

/// Why a command failed. The exit statuses are part of the interface: scripts branch on them.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The command finished, but some frames failed.
    #[error("{failed} of {frames} frames failed{hint}")]
    SomeFrames {
        /// Frames without an image.
        failed: u64,
        /// Frames of the job.
        frames: u64,
        /// Where to find the reasons, starting with punctuation.
        hint: String,
    },
    /// Invalid input.
    #[error("{0}")]
    BadInput(String),
    /// No service responds.
    #[error("{0}")]
    NoServer(String),
    /// A required library is not installed.
    #[error("{0}")]
    RuntimeMissing(String),
    /// The store does not respond, or the set is paused; the same call may succeed later.
    #[error("{0}")]
    Later(String),
    /// A program that was started has reported its failure; its exit status.
    #[error("exit status {0}")]
    Reported(u8),
    /// Anything else.
    #[error("{0:#}")]
    Other(#[from] anyhow::Error),
}

impl Failure {
    /// Invalid input.
    pub fn input(reason: impl std::fmt::Display) -> Self {
        Self::BadInput(reason.to_string())
    }

    /// Exit status: 1 some frames failed (and anything unforeseen), 2 bad input, 3 no server, 4 runtime missing,
    /// 5 try again later.
    pub fn code(&self) -> u8 {
        match self {
            Self::SomeFrames { .. } | Self::Other(_) => 1,
            Self::BadInput(_) => 2,
            Self::NoServer(_) => 3,
            Self::RuntimeMissing(_) => 4,
            Self::Later(_) => 5,
            Self::Reported(status) => *status,
        }
    }
}

impl From<ClientError> for Failure {
    fn from(error: ClientError) -> Self {
        let message = error.to_string();
        match error {
            ClientError::Unreachable { .. } => Self::NoServer(message),
            ClientError::Refused(problem) if problem.is("runtime-missing") => Self::RuntimeMissing(message),
            ClientError::Refused(problem) if problem.status.is_client_error() => {
                Self::BadInput(name_option(&problem).unwrap_or(message))
            }
            ClientError::Refused(_) => Self::NoServer(message),
            ClientError::Proxy(_) => Self::BadInput(message),
            ClientError::Unreadable { .. }
            | ClientError::TooLong { .. }
            | ClientError::EndlessList { .. } => Self::Other(error.into()),
        }
    }
}

/// The message about a parameter of a query, with the option of the command in its place: its name has hyphens.
fn name_option(problem: &Problem) -> Option<String> {
    let text = |member: &str| problem.document()[member].as_str();
    let (parameter, detail) = (text("parameter")?, text("detail")?);
    let option = format!("--{}", parameter.replace('_', "-"));
    Some(detail.replace(&format!("`{parameter}`"), &option))
}

/// Prints a failure to standard error and returns the exit status.
pub fn end(program: &str, result: Result<(), Failure>) -> u8 {
    match result {
        Ok(()) => 0,
        Err(Failure::Reported(status)) => status,
        Err(failure) => {
            eprintln!("{program}: {failure}");
            failure.code()
        }
    }
}

#[cfg(test)]
mod tests {
    use ureq::http::StatusCode;

    use super::*;

    #[test]
    fn a_missing_runtime_has_its_own_exit_status() {
        let problem = Problem::new(
            StatusCode::CONFLICT,
            br#"{"type": "/problems/runtime-missing", "title": "x"}"#,
        );
        let failure = Failure::from(ClientError::Refused(problem));
        assert!(matches!(failure, Failure::RuntimeMissing(_)));
    }

    #[test]
    fn a_parameter_is_named_like_its_option() {
        let problem = Problem::new(
            StatusCode::BAD_REQUEST,
            br#"{"type": "/problems/invalid-filter", "title": "x", "parameter": "order_by",
                "detail": "`order_by` names the unknown column `uiqn`; did you mean `uiqm`?"}"#,
        );
        let failure = Failure::from(ClientError::Refused(problem));
        assert_eq!(
            failure.to_string(),
            "--order-by names the unknown column `uiqn`; did you mean `uiqm`?"
        );
    }
}
