//! Errors of sets as exit statuses.

use cli::exit::Failure;
use sets::SetError;

/// The exit status of an error. Engines decide by it whether to retry.
pub(crate) fn failure(error: SetError) -> Failure {
    match error {
        SetError::Refused(reason) => Failure::BadInput(reason),
        SetError::Later(reason) => Failure::Later(reason),
        SetError::Damaged(_) | SetError::Machine(_) => Failure::Other(anyhow::Error::msg(error.to_string())),
    }
}
