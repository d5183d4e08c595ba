//! Why a child refuses a file.

use scenes::SceneError;
use serde::Deserialize;
use serde::Serialize;

/// A rejected file: form field and reason.
#[derive(Serialize, Deserialize)]
pub(crate) struct Refusal {
    pub(crate) pointer: String,
    pub(crate) message: String,
}

impl Refusal {
    pub(crate) fn new(field: &str, message: impl ToString) -> Self {
        Self {
            pointer: format!("/{field}"),
            message: message.to_string(),
        }
    }
}

impl From<SceneError> for Refusal {
    fn from(error: SceneError) -> Self {
        Self::new(error.field(), error)
    }
}
