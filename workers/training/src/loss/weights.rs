//! The weights of the parts of the loss.

use super::pyramid::Pyramid;

/// Weights of the terms.
pub(super) const TEXTURE: f64 = 4.0;

pub(super) const COLOR: f64 = 15.0;

pub(super) const CONTENT: f64 = 6.4;

/// Ranges of two sets of pictures, one channel per picture. Only the order of the values within each set matters.
#[derive(Debug, Clone, Copy)]
pub struct Ranges<'a, T> {
    /// Ranges of the content pictures.
    pub contents: &'a [Pyramid<T>],
    /// Ranges of the style.
    pub style: &'a [Pyramid<T>],
}
