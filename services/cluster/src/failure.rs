//! What the failure of a set means for a shell.

use cli::exit::Failure;
use sets::SetError;

/// The exit status of an error: whether calling again can help is what engines decide by.
pub(crate) fn failure(error: SetError) -> Failure {
    match error {
        SetError::Refused(reason) => Failure::BadInput(reason),
        SetError::Later(reason) => Failure::Later(reason),
        SetError::Damaged(_) | SetError::Machine(_) => Failure::Other(anyhow::Error::msg(error.to_string())),
    }
}
