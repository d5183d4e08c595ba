//! Background light: the color of distant water, estimated from the pixels with the largest distance.

use imaging::{Plane, Rgb8, vectorized};

use super::rank::largest;
use crate::variant::Variant;

/// Share of the pixels that are candidates for the background light.
pub const TOP_SHARE: f64 = 0.001;

fn top_count(pixels: usize) -> usize {
    (pixels as f64 * TOP_SHARE).ceil() as usize
}

/// Among the pixels of the top share of `distance`, the color with the largest R² + G² + B², as codes. Ties go to the
/// farther pixel.
#[must_use]
pub fn brightest_of(picture: &Rgb8, distance: &Plane<f64>, variant: Variant) -> [u8; 3] {
    let mut best = (0, [0; 3]);
    for position in largest(distance, top_count(distance.data().len()), variant) {
        let color: [u8; 3] = std::array::from_fn(|channel| picture.data()[3 * position + channel]);
        let power = color.iter().map(|&code| u32::from(code).pow(2)).sum::<u32>();
        if power > best.0 {
            best = (power, color);
        }
    }
    best.1
}

/// The distance of the nearest pixel, `d0 = 1 - max |B_c - c| / max(B_c, 1 - B_c)` over all pixels and channels (Peng
/// and Cosman 2017, eq. 12): 1 if every pixel has the color of the light, 0 if one differs from it by the maximum.
#[must_use]
pub fn distance_offset(picture: &Rgb8, light: [f64; 3]) -> f64 {
    let (low, high) = extremes(picture);
    let farthest = (0..3).map(|c| {
        let (low, high) = (f64::from(low[c]) / 255.0, f64::from(high[c]) / 255.0);
        (light[c] - low).max(high - light[c]) / light[c].max(1.0 - light[c])
    });
    1.0 - farthest.fold(0.0, f64::max)
}

/// The smallest and the largest code of each channel of a non-empty picture.
pub(crate) fn extremes(picture: &Rgb8) -> ([u8; 3], [u8; 3]) {
    vectorized!(ends(picture.data()))
}

#[inline(always)]
fn ends(codes: &[u8]) -> ([u8; 3], [u8; 3]) {
    // Whole pixels that fill vectors.
    const RUN: usize = 96;
    let (mut low, mut high) = ([u8::MAX; RUN], [0u8; RUN]);
    let (runs, rest) = codes.as_chunks::<RUN>();
    for run in runs {
        for i in 0..RUN {
            low[i] = low[i].min(run[i]);
            high[i] = high[i].max(run[i]);
        }
    }
    for (i, &code) in rest.iter().enumerate() {
        low[i] = low[i].min(code);
        high[i] = high[i].max(code);
    }
    (
        [0, 1, 2].map(|channel| low.into_iter().skip(channel).step_by(3).fold(u8::MAX, u8::min)),
        [0, 1, 2].map(|channel| high.into_iter().skip(channel).step_by(3).fold(0, u8::max)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_brightest_of_the_farthest_is_the_light() {
        let picture = Rgb8::from_fn(2000, 1, |x, _| match x {
            7 => [10, 20, 30],
            8 => [40, 20, 30],
            9 => [250; 3],
            _ => [0; 3],
        });
        // The top share of 2000 pixels is two.
        let distance = Plane::from_fn(2000, 1, |x, _| if x == 7 || x == 8 { 1.0 } else { 0.0 });
        for variant in [Variant::Fast, Variant::Reference] {
            assert_eq!(brightest_of(&picture, &distance, variant), [40, 20, 30]);
        }
    }

    #[test]
    fn the_nearest_pixel_is_the_one_farthest_from_the_light() {
        let picture = Rgb8::from_fn(3, 1, |x, _| [51 * x as u8, 51, 51]);
        let light = [0.4, 0.2, 0.2];
        // Red reaches from 0 to 0.4: 0.4 away, of at most 0.6.
        assert!((distance_offset(&picture, light) - (1.0 - 0.4 / 0.6)).abs() < 1e-12);
    }

    #[test]
    fn the_ends_of_every_channel_are_found_wherever_they_lie() {
        for (width, at) in [(1, 0), (31, 30), (32, 5), (77, 76)] {
            let picture = Rgb8::from_fn(width, 1, |x, _| if x == at { [3, 250, 90] } else { [9, 90, 90] });
            let low = if width == 1 { [3, 250, 90] } else { [3, 90, 90] };
            let high = if width == 1 { [3, 250, 90] } else { [9, 250, 90] };
            assert_eq!(extremes(&picture), (low, high), "{width}");
        }
    }
}
