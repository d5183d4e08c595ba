//! HSCM: homomorphic filter, spatial median, CLAHE and color merge.
//!
//! Order: [`Luma`] → [`homomorphic`] → [`median`] → [`clahe`] → [`merge`]. The first stages process only the luma; the merge
//! restores the chroma of the input. Every stage is public, so that each can be compared with a reference from the output
//! of the previous stage.

pub mod clahe;
pub mod homomorphic;
mod luma;
pub mod median;
pub mod merge;

use imaging::{Channels, Plane, Raster, Samples};
use spec::{Hscm, ResultColor};

use homomorphic::Filter;
pub use luma::Luma;

use crate::result::{Enhanced, raster};
use crate::variant::Variant;
use crate::warning::{Warning, found};

/// Minimum pixels of a tile for a reliable histogram.
const TILE_PIXELS: usize = 64;

/// Enhances a picture of at least one pixel.
///
/// Gray stays gray. A 16-bit picture keeps its depth through the homomorphic stage and is reduced to 8 bit for the
/// merge; the result, including alpha, is 8 bit.
#[must_use]
pub(super) fn enhance(picture: &Raster, parameters: &Hscm, variant: Variant) -> Enhanced {
    let luma = Luma::new(picture);
    let warnings = warnings(&luma, parameters.tiles);
    let filter = Filter::new(parameters, picture.width());
    // Each stage frees its input before the next one allocates: fresh pages for every picture would cost a third of the
    // time.
    let filtered = homomorphic::homomorphic(&luma, &filter, variant);
    drop(luma);
    let smoothed = median::median(&filtered, parameters.median_px, variant);
    drop(filtered);
    let equalized = clahe::clahe(&smoothed, parameters.tiles, parameters.clip);
    drop(smoothed);

    let (channels, codes) = match parameters.color {
        ResultColor::Color => with_luma(picture, equalized),
        ResultColor::Gray => (Channels::Gray, equalized.into_data()),
    };
    Enhanced::new(raster(picture, channels, codes), warnings)
}

/// The luma after each stage: homomorphic filter, median, and CLAHE.
#[must_use]
pub fn stages(picture: &Raster, parameters: &Hscm) -> [Plane<u8>; 3] {
    let filter = Filter::new(parameters, picture.width());
    let filtered = homomorphic::homomorphic(&Luma::new(picture), &filter, Variant::Fast);
    let smoothed = median::median(&filtered, parameters.median_px, Variant::Fast);
    let equalized = clahe::clahe(&smoothed, parameters.tiles, parameters.clip);
    [filtered, smoothed, equalized]
}

/// Warnings about the equalization of tiles and the gain of dark parts.
pub(super) fn warnings(luma: &Luma, [across, down]: [usize; 2]) -> Vec<Warning> {
    let pixels = luma.codes().data().len();
    let (low, high) = luma.extremes();
    found([
        (low == high, Warning::Constant),
        (pixels < across * down * TILE_PIXELS, Warning::SmallTiles),
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
