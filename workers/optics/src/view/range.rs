//! Range along the ray, and the meaning of a pixel without one.

use std::borrow::Cow;

use imaging::{Plane, vectorized};
use spec::HoleRule;

/// The shortest range that is one, in meters: below it, and where it is not finite, the pixel is a hole.
pub const SHORTEST_M: f64 = 1e-3;

/// Whether a pixel has no range: NaN, infinite, negative, zero or below a millimeter.
#[inline(always)]
#[must_use]
pub fn is_hole(range: impl Into<f64>) -> bool {
    let range = range.into();
    !(range.is_finite() && range >= SHORTEST_M)
}

/// The range with holes replaced where the rule names a distance.
pub(crate) fn filled<T: Sample>(range: &Plane<T>, holes: HoleRule) -> Cow<'_, Plane<T>> {
    match holes {
        HoleRule::RangeM(meters) => {
            Cow::Owned(range.map(|&z| if is_hole(z) { T::from_meters(meters) } else { z }))
        }
        HoleRule::Background | HoleRule::Reject => Cow::Borrowed(range),
    }
}

/// The range of surfaces for daylight: the rule replaces holes.
#[must_use]
pub fn of_surfaces(range: &Plane<f32>, holes: HoleRule) -> Cow<'_, Plane<f32>> {
    filled(range, holes)
}

/// The farthest range in meters; `None` in a frame of holes.
#[must_use]
pub fn farthest(range: &Plane<f32>) -> Option<f64> {
    let (_, farthest) = bounds(range.data(), range.data(), f32::MAX)?;
    Some(f64::from(farthest))
}

/// f32 or f64.
pub(crate) trait Sample: Copy + Into<f64> {
    fn from_meters(meters: f64) -> Self;
}

impl Sample for f32 {
    fn from_meters(meters: f64) -> Self {
        meters as f32
    }
}

impl Sample for f64 {
    fn from_meters(meters: f64) -> Self {
        meters
    }
}

/// Number of partial bounds, so that the loop vectorizes.
const LANES: usize = 16;

/// Nearest and farthest range up to `most_m` meters among lit pixels with a range; `None` without such a pixel.
pub(crate) fn bounds(light: &[f32], range: &[f32], most_m: f32) -> Option<(f32, f32)> {
    let (nearest, farthest) = vectorized!(lane_bounds(light, range, most_m.min(f32::MAX)));
    let nearest = nearest.into_iter().fold(f32::INFINITY, f32::min);
    let farthest = farthest.into_iter().fold(0.0, f32::max);
    (nearest <= farthest).then_some((nearest, farthest))
}

#[inline(always)]
fn lane_bounds(light: &[f32], range: &[f32], most_m: f32) -> ([f32; LANES], [f32; LANES]) {
    let (mut nearest, mut farthest) = ([f32::INFINITY; LANES], [0.0f32; LANES]);
    for (light, range) in light.chunks(LANES).zip(range.chunks(LANES)) {
        for (((near, far), &l), &z) in nearest.iter_mut().zip(&mut farthest).zip(light).zip(range) {
            let counts = (l > 0.0) & (z >= SHORTEST_M as f32) & (z <= most_m);
            *near = near.min(if counts { z } else { f32::INFINITY });
            *far = far.max(if counts { z } else { 0.0 });
        }
    }
    (nearest, farthest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_pass_over_holes_and_dark_pixels() {
        let mut range = [5.0f32; 40];
        (range[3], range[20], range[33], range[39]) = (f32::NAN, 1.0, 0.5, 70.0);
        let mut light = [1.0f32; 40];
        light[33] = 0.0;
        assert_eq!(bounds(&light, &range, f32::MAX), Some((1.0, 70.0)));
        assert_eq!(bounds(&light, &range, 60.0), Some((1.0, 5.0)));
        assert_eq!(bounds(&light, &[f32::INFINITY; 40], f32::INFINITY), None);
    }

    #[test]
    fn what_is_no_distance_is_a_hole() {
        for range in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -1.0, 9.9e-4] {
            assert!(is_hole(range), "{range}");
        }
        assert!(!is_hole(1e-3_f32) && !is_hole(1e-3_f64) && !is_hole(1e6_f32));
    }
}
