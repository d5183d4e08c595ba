//! A picture at four resolutions.

use crate::layer::scale::{halved, unhalved};
use crate::real::Real;
use crate::tensor::Tensor;

/// Levels of a pyramid.
pub const LEVELS: usize = 4;

/// A picture, and its means of 2×2, 4×4 and 8×8 pixels.
#[derive(Debug, Clone)]
pub struct Pyramid<T> {
    /// From the finest to the coarsest.
    pub levels: [Tensor<T>; LEVELS],
}

impl<T: Real> Pyramid<T> {
    /// The pyramid of a picture.
    #[must_use]
    pub fn new(picture: Tensor<T>) -> Self {
        let second = halved(&picture);
        let third = halved(&second);
        let fourth = halved(&third);
        Self {
            levels: [picture, second, third, fourth],
        }
    }

    /// Zeros of the same sizes.
    pub(crate) fn like(&self) -> Self {
        Self {
            levels: self.levels.each_ref().map(Tensor::like),
        }
    }

    /// The gradient of the picture from those of all its levels.
    pub(crate) fn collapse(self) -> Tensor<T> {
        let [mut first, mut second, mut third, fourth] = self.levels;
        unhalved(&fourth, &mut third);
        unhalved(&third, &mut second);
        unhalved(&second, &mut first);
        first
    }
}
