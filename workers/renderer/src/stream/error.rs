//! Why a frame of a stream has no picture.

use crate::error::RenderError;

/// Why a frame of a stream has no picture.
#[derive(Debug, thiserror::Error)]
pub enum StreamError {
    /// The input contradicts itself or the job.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))]
    Input(Vec<InputError>),
    /// The frame cannot be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// A wrong part of an input.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{field}` {message}")]
pub struct InputError {
    /// The part: `rgb`, `z_depth`, `range_m`, `instances`, `camera` or `pose`.
    pub field: &'static str,
    /// What is wrong, with value, limit and remedy.
    pub message: String,
}

impl InputError {
    pub(crate) fn new(field: &'static str, message: impl Into<String>) -> Self {
        let message = message.into();
        Self { field, message }
    }
}
