//! RGHS: relative global histogram stretching (Huang, Wang, Song, Sequeira and Mavromatis 2018).
//!
//! 1. Green and blue times 0.5 / mean, clipped.
//! 2. Each channel, as rounded codes: with the mode a, `I_min` the code at 0.5 % of those below a (a if there are
//!    none), `I_max` the code at 0.5 % from the top of the others, a line maps `I_min..I_max` to `O_min..O_max`:
//!    `O_min = a - 0.655 a`; `O_max = (1.526 + (n + 1) / 2) a / (k t)` where `n = floor((255 - I_max) k t / a)` is at
//!    least 1, else 255, never below `I_max` and never above 255. `t = N³` with N = (0.83, 0.95, 0.97), k = 1.1 for red
//!    and 0.9 for green and blue: the exponent and k are this project's reading, since the sources leave them open.
//! 3. CIE Lab: L stretched between its 1 % tails to 0..=100; a and b become `p · 1.3^(1 - |p| / 128)`.
//!
//! A picture of one color skips steps 1 and 2. Known failures: a mode of 0 (much black) cannot be stretched relative
//! to; a few colors are pushed apart; a picture of one color only becomes more colorful.

mod curve;
mod lightness;

use imaging::Raster;

use crate::result::{Enhanced, OfGray};
use crate::signs::{self, Signs};
use crate::variant::Variant;
use crate::warning::Warning;

/// Stretches a picture of at least one pixel. Gray stays gray; 16 bit is reduced to 8.
#[must_use]
pub(crate) fn enhance(picture: &Raster, variant: Variant) -> Enhanced {
    let colors = picture.to_rgb8();
    let curves = curve::curves(&colors, variant);
    let stretched = lightness::stretched(&colors, &curves, variant);
    let warnings = signs::warnings(
        &colors,
        &stretched,
        &[(Warning::BlackMode, Signs::has_black_mode)],
    );
    Enhanced::from_colors(picture, &stretched, OfGray::Gray, warnings)
}

#[cfg(test)]
mod tests {
    use imaging::Rgb8;

    use super::*;

    fn rghs(colors: &Rgb8) -> Rgb8 {
        enhance(&Raster::from(colors.clone()), Variant::Fast)
            .picture
            .to_rgb8()
    }

    #[test]
    fn black_and_white_stay() {
        for pixel in [[0; 3], [255; 3]] {
            let picture = Rgb8::from_fn(9, 9, |_, _| pixel);
            assert_eq!(rghs(&picture), picture);
        }
    }

    #[test]
    fn a_dull_picture_gets_the_full_range_of_lightness() {
        let dull = Rgb8::from_fn(60, 50, |x, y| {
            [40 + (x / 4) as u8, 90 + (y / 3) as u8, 110 + ((x + y) / 7) as u8]
        });
        let codes = rghs(&dull).to_gray8();
        let (low, high) = (
            codes.data().iter().min().unwrap(),
            codes.data().iter().max().unwrap(),
        );
        assert!(*low < 12 && *high > 240, "{low} {high}");
    }
}
