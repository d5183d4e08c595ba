//! Errors of style networks.

/// A model that cannot run, or an unsuitable picture. All are deterministic: a retry does not help.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StyleError {
    /// The file is not an ONNX model, or its inputs or outputs have another shape.
    #[error("style `{name}` cannot be used: {reason}")]
    Model {
        /// The model.
        name: String,
        /// Cause.
        reason: String,
    },
    /// The frame is empty or has a non-finite sample, which the network would spread over the whole frame, or the noise
    /// has another size.
    #[error("style `{name}`: {reason}")]
    Input {
        /// The model.
        name: String,
        /// Cause.
        reason: String,
    },
    /// The network failed, for instance because it supports one size only, or its output is not a picture of the frame.
    #[error("style `{name}` {reason}")]
    Run {
        /// The model.
        name: String,
        /// Cause.
        reason: String,
    },
}
