//! HSCM: homomorphic filter, spatial median, CLAHE and circular mask.
//!
//! The chain is plain calls in this order: [`Luma`] → [`homomorphic`] → [`median`] → [`clahe`] → [`merge`] →
//! [`circle`]. The first stages work on luma alone; colors come back in the merge, which keeps the chroma of the
//! input. Every stage is public, so that each can be compared with a reference given the stage before it.

pub mod circle;
pub mod clahe;
pub mod homomorphic;
mod luma;
pub mod median;
pub mod merge;
mod options;

use imaging::{Channels, Plane, Raster, Rgb8, Samples};

pub use luma::Luma;
pub use options::{
    CIRCLE_MAX, Circle, GRID_MAX, MAGNITUDE_MAX, MAGNITUDE_MIN, MEDIAN_MAX, OptionError, Options, Output,
    Profile, Settings,
};

use crate::method::Variant;
use crate::result::{EnhanceError, Enhanced};
use crate::warning::{Warning, found};

/// Enhances one picture.
///
/// Gray stays gray. A 16-bit picture keeps its depth through the homomorphic stage and is reduced to 8 bit for the
/// merge; the result, alpha included, is 8 bit.
///
/// # Errors
/// [`EnhanceError::Empty`] for a picture without a pixel.
pub fn enhance(picture: &Raster, options: &Options, variant: Variant) -> Result<Enhanced, EnhanceError> {
    let (width, height) = (picture.width(), picture.height());
    if width == 0 || height == 0 {
        return Err(EnhanceError::Empty { width, height });
    }
    let settings = options.settings();
    let luma = Luma::of(picture);
    let warnings = warnings(&luma, settings.grid);
    // What a stage has used up is given back before the next one asks for memory: pages that the system must find anew
    // for every picture cost a third of the whole otherwise.
    let filtered = homomorphic::homomorphic(&luma, options, variant);
    drop(luma);
    let smoothed = median::median(&filtered, settings.median, variant);
    drop(filtered);
    let equalized = clahe::clahe(&smoothed, settings.grid, settings.clip_limit);
    drop(smoothed);

    let alpha = picture.alpha().map(|alpha| Samples::U8(alpha.to_u8()));
    let (channels, unmasked) = if picture.channels() == Channels::Gray || settings.output == Output::Gray {
        (Channels::Gray, equalized.into_data())
    } else {
        (Channels::Rgb, merged(picture, equalized))
    };
    let raster = |codes| {
        Raster::new(width, height, channels, Samples::U8(codes), alpha.clone())
            .expect("the stages keep the size")
    };
    let mut shown = unmasked.clone();
    if let Some(circle) = &settings.mask {
        circle::black_out(&mut shown, channels.count(), (width, height), circle);
    }
    Ok(Enhanced {
        picture: raster(shown),
        unmasked: raster(unmasked),
        mask: settings.mask.map(|circle| circle::plane(width, height, &circle)),
        warnings,
    })
}

/// What the equalization of tiles and the gain of dark parts should say.
pub(crate) fn warnings(luma: &Luma, (across, down): (usize, usize)) -> Vec<Warning> {
    let pixels = luma.codes().data().len();
    let (low, high) = luma.extremes();
    found([
        (low == high, Warning::Constant),
        (pixels < across * down * TILE_PIXELS, Warning::SmallTiles),
        (luma.is_dark(), Warning::Dark),
    ])
}

/// Pixels that a tile's histogram should rest on.
const TILE_PIXELS: usize = 64;

fn merged(picture: &Raster, luma: Plane<u8>) -> Vec<u8> {
    match picture.samples() {
        Samples::U8(codes) => merge::merge(codes, luma.data()),
        Samples::U16(_) => merge::merge(Rgb8::data(&picture.to_rgb8()), luma.data()),
    }
}
