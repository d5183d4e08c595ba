//! Inputs of metrics besides the picture.

use std::fmt;

/// What a metric needs besides the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Needs {
    /// The picture alone.
    Nothing,
    /// The clean picture, in air.
    PictureInAir,
    /// As many previous frames of the camera's path, as far as the path has them, with true motion and poses.
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
