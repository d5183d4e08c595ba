//! RD: integration of two dual-intensity pictures by the Rayleigh distribution (Abdul Ghani and Mat Isa 2014).
//!
//! In 0..=255 reals:
//! 1. The channel with the smallest mean is multiplied by med / min of the three means, the one with the largest by
//!    med / max, and clipped; a channel without light is unchanged, as is the largest if it would become 0.
//! 2. Each channel is stretched linearly from its ends to 0..=255.
//! 3. Each channel is split at its mean m. In each of the two sets, with the cumulative share C of a value's integer part,
//!    `f(C) = min(255, 255 sqrt(-2 α² ln(1 - (1 - exp(-1 / (2 α²))) C)))`, α the scale, `f(1) = 255`. The lower picture is
//!    f where the value is at most m and 255 elsewhere, the upper picture is f where it is above m and 0 elsewhere.
//! 4. The mean of the two pictures, each truncated to integer codes. A channel of one value is unchanged.
//! 5. HSV: saturation and value are stretched between their 1 % tails to 0..=1; values outside are unchanged.
//!
//! Known failures: a channel without light is ignored; in a picture of few values the two sets are pushed to the ends;
//! saturation beyond its tails is unchanged, which creates abrupt color edges.

mod curve;
mod saturation;

use imaging::Raster;
use spec::Rayleigh;

use crate::result::{Enhanced, OfGray};
use crate::signs::{self, Signs};
use crate::variant::Variant;
use crate::warning::Warning;

/// Stretches a picture of at least one pixel. Gray stays gray; 16 bit is reduced to 8.
#[must_use]
pub(crate) fn enhance(picture: &Raster, parameters: &Rayleigh, variant: Variant) -> Enhanced {
    let colors = picture.to_rgb8();
    let curves = curve::curves(&colors, parameters.rayleigh_scale, variant);
    let stretched = saturation::stretched(&colors, &curves, variant);
    let others: &[signs::FailureSign] = &[(Warning::ChannelWithoutLight, Signs::lacks_a_channel)];
    let warnings = signs::warnings(&colors, &stretched, others);
    Enhanced::from_colors(picture, &stretched, OfGray::Gray, warnings)
}

#[cfg(test)]
mod tests {
    use imaging::Rgb8;

    use super::*;

    fn rd(colors: &Rgb8) -> Rgb8 {
        enhance(&Raster::from(colors.clone()), &Rayleigh::default(), Variant::Fast)
            .picture
            .to_rgb8()
    }

    #[test]
    fn a_channel_without_light_stays_black() {
        let picture = Rgb8::from_fn(40, 30, |x, y| [0, (3 * x + 20) as u8, (5 * y + 10) as u8]);
        assert!(rd(&picture).pixels().all(|pixel| pixel[0] == 0));
    }

    #[test]
    fn one_gray_stays_what_it_is() {
        let picture = Rgb8::from_fn(7, 7, |_, _| [90; 3]);
        assert_eq!(rd(&picture), picture);
    }

    #[test]
    fn a_dull_picture_gets_the_full_range() {
        let dull = Rgb8::from_fn(60, 50, |x, y| {
            [40 + (x / 4) as u8, 90 + (y / 3) as u8, 110 + ((x + y) / 7) as u8]
        });
        let stretched = rd(&dull);
        let (low, high) = (
            stretched.data().iter().min().unwrap(),
            stretched.data().iter().max().unwrap(),
        );
        assert!(*low < 10 && *high > 245, "{low} {high}");
    }
}
