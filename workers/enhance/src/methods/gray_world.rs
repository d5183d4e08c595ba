//! Gray world: assumes that the mean of a scene is gray and scales each channel to the mean of all (Buchsbaum 1980, "A
//! spatial processor model for object color perception").
//!
//! `c' = c · m / m_c`, with `m_c` the mean of channel c and `m` the mean of the three. A channel without light stays
//! black.

use imaging::Raster;

use crate::blocks::histogram;
use crate::result::{Enhanced, OfGray};
use crate::signs::{self, Signs};
use crate::warning::Warning;

/// Balances a picture of at least one pixel.
#[must_use]
pub(crate) fn enhance(picture: &Raster) -> Enhanced {
    let colors = picture.to_rgb8();
    let sums = histogram::histograms(&colors).each_ref().map(histogram::sum);
    let total: u64 = sums.iter().sum();
    let curves = sums.map(|sum| curve(total, sum));
    let mut balanced = colors.clone();
    for pixel in balanced.data_mut().chunks_exact_mut(3) {
        for (code, curve) in pixel.iter_mut().zip(&curves) {
            *code = curve[usize::from(*code)];
        }
    }
    let others: &[signs::FailureSign] = &[(Warning::ChannelWithoutLight, Signs::lacks_a_channel)];
    let warnings = signs::warnings(&colors, &balanced, others);
    Enhanced::from_colors(picture, &balanced, OfGray::Gray, warnings)
}

/// Every code times `total / (3 sum)`, rounded.
fn curve(total: u64, sum: u64) -> [u8; 256] {
    let gain = if sum > 0 {
        total as f64 / (3 * sum) as f64
    } else {
        1.0
    };
    std::array::from_fn(|code| (code as f64 * gain + 0.5).min(255.0) as u8)
}

#[cfg(test)]
mod tests {
    use imaging::Rgb8;

    use super::*;

    #[test]
    fn channel_means_become_equal_where_nothing_clips() {
        let picture = Rgb8::from_fn(2, 1, |x, _| if x == 0 { [10, 20, 60] } else { [20, 40, 30] });
        // Means 15, 30, 45: gains 2, 1 and 2/3.
        let enhanced = enhance(&Raster::from(picture)).picture.to_rgb8();
        assert_eq!(enhanced.data(), &[20, 20, 40, 40, 40, 20]);
    }

    #[test]
    fn a_channel_without_light_stays_black() {
        let picture = Rgb8::from_fn(3, 3, |_, _| [0, 90, 90]);
        assert_eq!(
            enhance(&Raster::from(picture)).picture.to_rgb8().pixel(1, 1),
            [0, 60, 60]
        );
    }
}
