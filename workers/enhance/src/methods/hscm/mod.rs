//! HSCM: homomorphic filter, spatial median, CLAHE and circular mask.
//!
//! Order: [`Luma`] → [`homomorphic`] → [`median`] → [`clahe`] → [`merge`] → [`circle`]. The first stages process only
//! the luma; the merge restores the chroma of the input. Every stage is public, so that each can be compared with a
//! reference from the output of the previous stage.

pub mod circle;
pub mod clahe;
pub mod homomorphic;
mod luma;
pub mod median;
pub mod merge;

use imaging::{Channels, Plane, Raster, Samples};

pub use luma::Luma;

use crate::result::{Enhanced, raster};
use crate::variant::Variant;
use crate::warning::{Warning, found};

/// Cutoff of the homomorphic filter: `delta` is the width of the picture over this, in bins of the transform.
pub const CUTOFF: f64 = 32.0;
/// Tiles of CLAHE across and down.
pub const GRID: (usize, usize) = (8, 8);
/// Contrast limit of CLAHE, in mean bins.
pub const CLIP_LIMIT: f64 = 2.0;
/// Minimum pixels of a tile for a reliable histogram.
const TILE_PIXELS: usize = 64;

/// Enhances a picture of at least one pixel.
///
/// Gray stays gray. A 16-bit picture keeps its depth through the homomorphic stage and is reduced to 8 bit for the
/// merge; the result, including alpha, is 8 bit.
#[must_use]
pub(super) fn enhance(picture: &Raster, variant: Variant) -> Enhanced {
    let (width, height) = (picture.width(), picture.height());
    let luma = Luma::new(picture);
    let warnings = warnings(&luma);
    // Each stage frees its input before the next one allocates: fresh pages for every picture would cost a third of the
    // time.
    let filtered = homomorphic::homomorphic(&luma, CUTOFF, variant);
    drop(luma);
    let smoothed = median::median(&filtered, variant);
    drop(filtered);
    let equalized = clahe::clahe(&smoothed, GRID, CLIP_LIMIT);
    drop(smoothed);

    let (channels, unmasked) = with_luma(picture, equalized);
    let mut shown = unmasked.clone();
    circle::black_out(&mut shown, channels.count(), (width, height), &circle::HSCM);
    Enhanced {
        picture: raster(picture, channels, shown),
        unmasked: raster(picture, channels, unmasked),
        mask: Some(circle::plane(width, height, &circle::HSCM)),
        warnings,
    }
}

/// Warnings about the equalization of tiles and the gain of dark parts.
pub(super) fn warnings(luma: &Luma) -> Vec<Warning> {
    let pixels = luma.codes().data().len();
    let (low, high) = luma.extremes();
    found([
        (low == high, Warning::Constant),
        (pixels < GRID.0 * GRID.1 * TILE_PIXELS, Warning::SmallTiles),
        (luma.is_dark(), Warning::Dark),
    ])
}

/// Codes with a new luma: only the luma for a gray picture, with the chroma of the picture for a color one.
pub(super) fn with_luma(picture: &Raster, luma: Plane<u8>) -> (Channels, Vec<u8>) {
    let codes = match (picture.channels(), picture.samples()) {
        (Channels::Gray, _) => luma.into_data(),
        (Channels::Rgb, Samples::U8(codes)) => merge::merge(codes, luma.data()),
        (Channels::Rgb, Samples::U16(_)) => merge::merge(picture.to_rgb8().data(), luma.data()),
    };
    (picture.channels(), codes)
}
