//! Maximum and minimum of slices, several lanes at a time, so that the loops vectorize.

use imaging::Rgb;
use imaging::vectorized;

const LANES: usize = 16;

/// The greatest; at least 0.
pub(crate) fn greatest(values: &[f32]) -> f32 {
    let mut lanes = [0.0f32; LANES];
    vectorized!(each(values, &mut lanes, f32::max));
    lanes.into_iter().fold(0.0, f32::max)
}

/// The least.
pub(crate) fn least(values: &[f32]) -> f32 {
    let mut lanes = [f32::MAX; LANES];
    vectorized!(each(values, &mut lanes, f32::min));
    lanes.into_iter().fold(f32::MAX, f32::min)
}

/// The largest light of each channel; at least 0.
#[must_use]
pub fn brightest(light: &Rgb<f32>) -> [f32; 3] {
    light.planes().each_ref().map(|plane| greatest(plane.data()))
}

#[inline(always)]
fn each(values: &[f32], lanes: &mut [f32; LANES], of: impl Fn(f32, f32) -> f32) {
    for chunk in values.chunks(LANES) {
        for (lane, &value) in lanes.iter_mut().zip(chunk) {
            *lane = of(*lane, value);
        }
    }
}
