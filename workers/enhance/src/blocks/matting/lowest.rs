//! Refinement at full size only where the result is low.
//!
//! Elsewhere half the size is accurate enough: a quarter of the pixels and, with a larger λ, half of the steps. Around
//! the lowest values, and in the region visited by the search for the lowest mean, the iteration continues at full
//! size, since the noise of single pixels decides which are the lowest. Restricting the full-size steps to high
//! frequencies (eigenvalues from 0.1) lost the light of twice as many frames: low frequencies differ, too.

use imaging::Plane;

use super::cells::CellSet;
use super::chebyshev::System;
use super::halves::{doubled, halved, mean_code, mean_value};
use super::{CLOSENESS, LARGE, Matting};
use crate::blocks::guided::Guide;
use crate::blocks::lowest_part;
use crate::variant::Variant;

/// λ at half the size.
const HALF_CLOSENESS: f64 = 0.05;
/// Residual at half the size relative to the right-hand side.
const HALF_RESIDUAL: f64 = 0.02;
/// Remaining share of the initial residual at full size.
const RESIDUAL: f64 = 0.05;
/// Share of the pixels to solve for at full size.
const LOWEST: f64 = 0.025;
/// The full-size region is where the search for the lowest mean has narrowed to one of this many parts.
const PARTS: usize = 16;
/// Margin of cells around both: columns and rows.
const MARGIN: (usize, usize) = (1, 2);
/// Shorter sides have no window at half the size.
const SIDE_MIN: usize = 5;

/// Refines a plane of the guide's size as [`Matting::refined`]; large pictures approximately, and closely around the
/// lowest values.
///
/// From 180 000 pixels on the fast variant solves the system at half the size (means of 2 × 2 pixels, λ = 0.05) to a
/// residual of 0.02, then continues at full size with λ = 0.01 where the plane is low, until a twentieth of the
/// residual is left: within 32 columns and 16 rows of the lowest 2.5 % of the values and of the sixteenth of the
/// picture visited by [`lowest`](crate::blocks::lowest). The reference, and the fast variant in smaller pictures,
/// refine the whole plane.
///
/// # Panics
/// If the sizes differ.
#[must_use]
pub fn lowest_refined(guide: &Guide, plane: &Plane<f64>, variant: Variant) -> Plane<f64> {
    let channels = guide.channels();
    let (width, height) = plane.size();
    if variant == Variant::Reference || width * height < LARGE || width.min(height) < SIDE_MIN {
        return Matting::new(guide, variant).refined(plane);
    }
    assert_eq!(
        channels[0].size(),
        plane.size(),
        "the plane has the picture's size"
    );
    let codes = channels.each_ref().map(|codes| halved(codes, mean_code));
    let [half] = System::new(&codes, HALF_CLOSENESS).solved([&halved(plane, mean_value)], HALF_RESIDUAL);
    let start = doubled(&half, plane.size());
    let cells = CellSet::at_most(&start, low_value(half, LOWEST))
        .with_region(&lowest_part(&start, PARTS))
        .grown(MARGIN.0, MARGIN.1);
    System::in_cells(channels, CLOSENESS[1], cells).continued(plane, &start, RESIDUAL)
}

/// The quantile of the values at a share.
fn low_value(mut plane: Plane<f64>, share: f64) -> f64 {
    let values = plane.data_mut();
    let place = (share * values.len() as f64) as usize;
    *values.select_nth_unstable_by(place, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use imaging::Rgb8;

    use super::*;

    /// Largest error of the low part relative to the range, which is 1 here.
    const LOW_AGREEMENT: f64 = 0.02;

    #[test]
    fn low_values_are_those_of_the_whole_system() {
        let (width, height) = (541, 343);
        let picture = Rgb8::from_fn(width, height, |x, y| {
            let noise = (x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca6b)) >> 7;
            [40, 90, 100].map(|code| code + (noise % 9) as u8 + (x / 60 % 3 * 20) as u8)
        });
        let guide = Guide::new(&picture);
        let plane = Plane::from_fn(width, height, |x, y| {
            let (x, y) = (x as f64 / width as f64 - 0.7, y as f64 / height as f64 - 0.4);
            (2.0 * (x * x + y * y)).min(1.0)
        });
        let whole = Matting::new(&guide, Variant::Fast).refined(&plane);
        let low = lowest_refined(&guide, &plane, Variant::Fast);
        let limit = low_value(whole.clone(), 0.01);
        let pairs = whole.data().iter().zip(low.data());
        let lowest = pairs.filter(|(whole, _)| **whole <= limit);
        let most = lowest.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(most < LOW_AGREEMENT, "{most}");
    }

    #[test]
    fn long_pictures_and_constants_are_no_exception() {
        for (width, height) in [(60_000, 3), (3, 60_000), (45_000, 4), (36_000, 5), (500, 361)] {
            let guide = Guide::new(&Rgb8::from_fn(width, height, |x, y| {
                [(x % 50) as u8, (y % 70) as u8, 9]
            }));
            let refined = lowest_refined(&guide, &Plane::filled(width, height, 0.7), Variant::Fast);
            assert!(refined.data().iter().all(|value| (value - 0.7).abs() < 1e-6));
        }
    }
}
