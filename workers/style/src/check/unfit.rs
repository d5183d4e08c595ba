//! Why a network cannot be used.

use crate::error::StyleError;
use crate::picture::NetworkError;
use crate::runtime::RuntimeMissing;

/// Required sizes: the smallest, one divisible by no stride, the usual one.
pub(super) const SIZES: [(usize, usize); 3] = [(1, 1), (33, 17), (768, 492)];
/// The usual size.
pub(super) const USUAL: (usize, usize) = SIZES[2];

/// The size for the frames beyond the first.
pub(super) const SMALL: (usize, usize) = SIZES[1];

/// A model that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum Unfit {
    /// Not an ONNX file.
    #[error("it is no ONNX file")]
    NotOnnx,
    /// A tensor is stored outside of the file.
    #[error("its tensor `{tensor}` is stored in another file; all tensors of a model must be in one file")]
    External {
        /// The tensor's name.
        tensor: String,
    },
    /// Loading it takes too long.
    #[error("it has more than {most} nodes, the limit of a model")]
    TooManyNodes {
        /// The limit.
        most: usize,
    },
    /// A tensor is larger than the file can hold.
    #[error(
        "its tensor `{tensor}` has the sides {sides:?}, which are more than {most} elements together with its other tensors"
    )]
    TooLarge {
        /// The tensor's name.
        tensor: String,
        /// Its sides.
        sides: Vec<u64>,
        /// The limit.
        most: u64,
    },
    /// It does not load, fails, or returns an invalid picture.
    #[error(transparent)]
    Fails(#[from] StyleError),
    /// An enhancer or a metric fails on a test picture, or its output is not what its role needs.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// An enhancer returns the same value everywhere.
    #[error(
        "it returns {value} of 0 to 1 in every sample of a {width}×{height} picture of all levels; an enhancer must keep the scene"
    )]
    Flat {
        /// The value.
        value: f32,
        /// Columns of the picture.
        width: usize,
        /// Rows of the picture.
        height: usize,
    },
    /// A metric returns the same value for every test picture.
    #[error(
        "it returns {value} for every test picture: black, white, a ramp and a checkerboard; a metric must tell them apart"
    )]
    Indifferent {
        /// The value.
        value: f64,
    },
    /// Most samples of an enhancer are no colors.
    #[error(
        "it returns values from {least} to {most} of 0 to 1 for a {width}×{height} picture; another input scale may fit: 0..1, 0..255 or -1..1"
    )]
    Scale {
        /// Its least sample.
        least: f32,
        /// Its greatest sample.
        most: f32,
        /// Columns of the picture.
        width: usize,
        /// Rows of the picture.
        height: usize,
    },
    /// Two runs of an enhancer or a metric differ.
    #[error("two runs on the same {width}×{height} picture differ; a network must not draw random numbers")]
    Drawn {
        /// Columns of the picture.
        width: usize,
        /// Rows of the picture.
        height: usize,
    },
    /// Several defects.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))]
    Several(Vec<Unfit>),
    /// It returns a sample that is not finite.
    #[error("it returns a sample of {value} for a {width}×{height} frame")]
    NotFinite {
        /// The sample.
        value: f32,
        /// Columns of the frame.
        width: usize,
        /// Rows of the frame.
        height: usize,
    },
    /// It returns the same value everywhere.
    #[error("it returns {value} in every sample of a frame of all levels")]
    Constant {
        /// The value.
        value: f32,
    },
    /// Most of its samples are no colors.
    #[error(
        "it returns values from {least} to {most} for a frame of 0 to 1, where 0 is black and 1 is white; if it takes and returns 0 to \
         255, add it with the scale 255"
    )]
    Saturated {
        /// Its least sample.
        least: f32,
        /// Its greatest sample.
        most: f32,
    },
    /// It draws random numbers: frames would not be reproducible.
    #[error(
        "two runs on the same {}×{} frame differ; a style must not draw random numbers, but may have an input `noise`",
        SMALL.0,
        SMALL.1
    )]
    Random,
    /// It requires ONNX Runtime, which is missing.
    #[error(transparent)]
    Runtime(#[from] RuntimeMissing),
}
