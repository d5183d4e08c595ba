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
    /// The frame has no pixel.
    #[error("style `{name}`: the frame is empty: {width}×{height}")]
    Empty {
        /// The model.
        name: String,
        /// Columns of the frame.
        width: usize,
        /// Rows of the frame.
        height: usize,
    },
    /// A sample that is NaN or infinite: the network would spread it over the whole frame.
    #[error("style `{name}`: {input} is {value} at pixel ({x}, {y}) but must be finite")]
    NotFinite {
        /// The model.
        name: String,
        /// `image` or `noise`.
        input: &'static str,
        /// Column of the first such sample, plane by plane.
        x: usize,
        /// Row of the first such sample.
        y: usize,
        /// The sample.
        value: f32,
    },
    /// The noise has another size than the frame.
    #[error("style `{name}`: noise is {noise_width}×{noise_height} but the frame is {width}×{height}")]
    NoiseSize {
        /// The model.
        name: String,
        /// Columns of the noise.
        noise_width: usize,
        /// Rows of the noise.
        noise_height: usize,
        /// Columns of the frame.
        width: usize,
        /// Rows of the frame.
        height: usize,
    },
    /// The network stopped, for instance because it takes one size only.
    #[error("style `{name}` failed on a frame of {width}×{height}: {reason}")]
    Run {
        /// The model.
        name: String,
        /// Columns of the frame.
        width: usize,
        /// Rows of the frame.
        height: usize,
        /// What ONNX Runtime said.
        reason: String,
    },
    /// The network answered something that is no picture of this frame.
    #[error("style `{name}` answered {answer} to a frame of {width}×{height}")]
    Answer {
        /// The model.
        name: String,
        /// What it answered.
        answer: String,
        /// Columns of the frame.
        width: usize,
        /// Rows of the frame.
        height: usize,
    },
}
