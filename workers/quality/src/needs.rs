//! Inputs of metrics besides the picture.

use std::fmt;

/// An input of a metric besides the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Needs {
    /// The picture alone.
    Nothing,
    /// The clean picture, in air.
    PictureInAir,
    /// Up to this number of previous frames of the camera's path, with true motion and poses.
    PreviousFrames(usize),
    /// The true illumination and reflectance.
    Illumination,
}

/// The input as a part of a sentence: `a clean picture`.
impl fmt::Display for Needs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Nothing => "the picture",
            Self::PictureInAir => "a clean picture",
            Self::PreviousFrames(_) => "the previous frame of a camera path",
            Self::Illumination => "the true illumination",
        })
    }
}
