//! Why a style network did not run.

/// A model that cannot run, or a picture that it cannot take. All follow from the model and the frame: trying again
/// does not help.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StyleError {
    /// The file is no ONNX model, or its inputs or outputs have another form.
    #[error("style `{name}` cannot be used: {reason}")]
    Model {
        /// The model.
        name: String,
        /// What is wrong.
        reason: String,
    },
    /// The frame has no pixel or a sample that is not finite, which the network would spread over the whole frame, or the noise
    /// has another size.
    #[error("style `{name}`: {reason}")]
    Input {
        /// The model.
        name: String,
        /// What is wrong.
        reason: String,
    },
    /// The network stopped, for instance because it takes one size only, or returned something that is no picture of the frame.
    #[error("style `{name}` {reason}")]
    Run {
        /// The model.
        name: String,
        /// What it did.
        reason: String,
    },
}
