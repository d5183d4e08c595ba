//! Results and errors of methods.

use imaging::{Channels, Raster, Rgb8, Samples};

use crate::warning::Warning;

/// The result of a method.
#[derive(Debug, Clone, PartialEq)]
pub struct Enhanced {
    /// The result, 8 bit.
    pub picture: Raster,
    /// Known failures detected in this picture.
    pub warnings: Vec<Warning>,
}

/// A picture that cannot be enhanced.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum EnhanceError {
    /// The picture has no pixels.
    #[error("picture is {width}×{height} but needs at least 1×1")]
    Empty {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// The picture exceeds the method's limit: the method holds many full-size planes.
    #[error("picture is {width}×{height} = {pixels} pixels but the limit of {method} is {limit}")]
    TooLarge {
        /// The method's name.
        method: &'static str,
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Their product.
        pixels: usize,
        /// Pixel limit.
        limit: usize,
    },
    /// A drawn mask cannot be decoded.
    #[error("the mask {0}")]
    Mask(String),
    /// A drawn mask has another size.
    #[error("picture is {}×{} but its mask is {}×{}; draw the mask in the size of the picture", .picture.0, .picture.1, .mask.0, .mask.1)]
    MaskSize {
        /// Columns and rows of the picture.
        picture: (usize, usize),
        /// Columns and rows of the mask.
        mask: (usize, usize),
    },
    /// A network of the user failed.
    #[error("network `{model}` {reason}")]
    Network {
        /// The network's name.
        model: String,
        /// Cause.
        reason: String,
    },
}

/// Channels of the result for a gray picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum OfGray {
    /// The gray codes of the colored result.
    Gray,
    /// The colored result: a restoration adds color.
    Color,
}

impl Enhanced {
    pub(crate) fn new(picture: Raster, warnings: Vec<Warning>) -> Self {
        Self { picture, warnings }
    }

    /// The result of a method from its colors.
    pub(crate) fn from_colors(
        source: &Raster,
        colors: &Rgb8,
        of_gray: OfGray,
        warnings: Vec<Warning>,
    ) -> Self {
        let is_gray = source.channels() == Channels::Gray && of_gray == OfGray::Gray;
        let picture = if is_gray {
            raster(source, Channels::Gray, colors.to_gray8().into_data())
        } else {
            raster(source, Channels::Rgb, colors.data().to_vec())
        };
        Self::new(picture, warnings)
    }
}

/// A raster of 8-bit codes with the sides and the alpha of the source.
pub(crate) fn raster(source: &Raster, channels: Channels, codes: Vec<u8>) -> Raster {
    let alpha = source.alpha().map(|alpha| Samples::U8(alpha.to_u8()));
    Raster::new(
        source.width(),
        source.height(),
        channels,
        Samples::U8(codes),
        alpha,
    )
    .expect("a method keeps the size of its picture")
}
