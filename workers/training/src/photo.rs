//! Style photos: requirements and preparation.

use imaging::{Rgb, Rgb8, codec};

use crate::loss::pyramid::Pyramid;
use crate::tensor::Tensor;
use crate::transfer::ColorStats;
use crate::veil;

/// Larger photos are reduced to this longest side: texture is learned at the scale of ordinary frames.
pub const MAX_SIDE_PX: usize = 768;
/// Shortest side: the coarsest level must contain a patch of 7 pixels.
pub const MIN_SIDE_PX: usize = 64;
/// Minimum standard deviation of a channel, of 255: a flatter photo teaches only one color.
pub const MIN_SPREAD: f64 = 2.0;

/// A photo unsuitable for training.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PhotoError {
    /// A side is too short.
    #[error(
        "the photo is {width}×{height} but needs at least {MIN_SIDE_PX}×{MIN_SIDE_PX} pixels (after reduction to {MAX_SIDE_PX})"
    )]
    TooSmall {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// The photo has a single color, or nearly so.
    #[error("the photo is flat: its samples deviate by {spread:.2} of 255; must by {MIN_SPREAD}")]
    Flat {
        /// Largest standard deviation of a channel, of 255.
        spread: f64,
    },
}

/// A photo prepared for training.
#[derive(Debug, Clone)]
pub struct Photo {
    pub(crate) pyramid: Pyramid<f32>,
    /// Range estimated from the veil.
    pub(crate) range: Pyramid<f32>,
}

impl Photo {
    /// Prepares a picture of sRGB codes.
    ///
    /// # Errors
    /// [`PhotoError`]: too small, or flat.
    pub fn new(picture: &Rgb8) -> Result<Self, PhotoError> {
        let reduced = codec::downscale(picture, MAX_SIDE_PX);
        let (width, height) = (reduced.width(), reduced.height());
        if width < MIN_SIDE_PX || height < MIN_SIDE_PX {
            return Err(PhotoError::TooSmall { width, height });
        }
        let tensor = Tensor::from(&Rgb::from_fn(width, height, |x, y| {
            reduced.pixel(x, y).map(|code| f32::from(code) / 255.0)
        }));
        let spread = 255.0 * ColorStats::measure(std::iter::once(&tensor)).spread();
        if spread < MIN_SPREAD {
            return Err(PhotoError::Flat { spread });
        }
        let pyramid = Pyramid::new(tensor);
        Ok(Self {
            range: Pyramid::new(veil::estimate(&pyramid)),
            pyramid,
        })
    }

    /// The order of its pixels by range estimated from the veil, 0 near and 1 far, row-major, at the size of the
    /// reduced photo.
    #[must_use]
    pub fn range(&self) -> &Tensor<f32> {
        &self.range.levels[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flat_and_small_photos_are_refused_and_gray_ones_taken() {
        let flat = Rgb8::from_fn(100, 80, |_, _| [7, 90, 200]);
        assert!(matches!(Photo::new(&flat).unwrap_err(), PhotoError::Flat { spread } if spread < 0.01));
        let small = Rgb8::from_fn(1, 1, |_, _| [0; 3]);
        let expected = PhotoError::TooSmall { width: 1, height: 1 };
        assert_eq!(Photo::new(&small).unwrap_err(), expected);
        let long = Rgb8::from_fn(4000, 100, |x, _| [x as u8; 3]);
        assert!(matches!(
            Photo::new(&long).unwrap_err(),
            PhotoError::TooSmall { height: 19, .. }
        ));
        let gray = Rgb8::from_fn(64, 64, |x, y| [(3 * x + y) as u8; 3]);
        assert!(Photo::new(&gray).is_ok());
    }
}
