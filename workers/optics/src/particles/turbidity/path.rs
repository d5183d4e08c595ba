//! Paths through the field in f32, in closed form.

use imaging::Plane;
use imaging::geometry::Intrinsics;
use imaging::vectorized;
use spec::HoleRule;

use super::{Field, PAIRS};
use crate::attenuation::masked;
use crate::elementary::small_sin_cos;
use crate::eye::Eye;
use crate::range::SHORTEST_M;

/// Pixels in one chunk.
pub(crate) const RUN: usize = 64;
/// Beyond this range the cosines have long cancelled: their sum no longer grows, m.
const FARTHEST_M: f32 = 1e5;

/// [`optical_path_reference`](super::optical_path_reference) with an error of at most [`path_rounding`](super::path_rounding) of
/// the path or of the range, using the longer one.
#[must_use]
pub fn optical_path(range: &Plane<f32>, field: &Field, eye: &Eye, holes: HoleRule) -> Plane<f32> {
    let stand_in = match holes {
        HoleRule::RangeM(meters) => Some(meters as f32),
        HoleRule::Background | HoleRule::Reject => None,
    };
    let rays = Rays::new(&field.seen_from(eye), &eye.camera);
    let (width, height) = range.size();
    let mut path = Plane::filled(width, height, 0.0f32);
    for y in 0..height {
        let at = y * width..(y + 1) * width;
        let path = &mut path.data_mut()[at];
        vectorized!(row(range.row(y), y, stand_in, &rays, path));
    }
    path
}

/// Ends of the paths in camera axes, m, and the sum of all cosines.
struct Lanes {
    right: [f32; RUN],
    down: [f32; RUN],
    ahead: [f32; RUN],
    sum: [f32; RUN],
}

impl Default for Lanes {
    fn default() -> Self {
        let [right, down, ahead, sum] = [[0.0; RUN]; 4];
        Self {
            right,
            down,
            ahead,
            sum,
        }
    }
}

/// A field before a camera, in f32.
pub(crate) struct Rays {
    waves: [[f32; 5]; PAIRS],
    /// 1/f, cx, cy.
    lens: [f32; 3],
}

impl Rays {
    /// `field` in the axes of the camera.
    pub(crate) fn new(field: &Field, camera: &Intrinsics) -> Self {
        let waves = field.pairs.map(|wave| {
            let [x, y, z] = wave.vector;
            let (sin, cos) = wave.phase.sin_cos();
            [0.5 * x, 0.5 * y, 0.5 * z, field.gain * cos, field.gain * sin].map(|v| v as f32)
        });
        let lens = [1.0 / camera.focal_px, camera.cx, camera.cy].map(|v| v as f32);
        Self { waves, lens }
    }

    /// Excess over 1 of the mean of the field from the camera to these distances, on the rays of a run of pixels.
    #[inline(always)]
    pub(crate) fn excess(&self, (x, y): (usize, usize), meters: &[f32; RUN]) -> [f32; RUN] {
        let [inverse_focal, cx, cy] = self.lens;
        let v = (y as f32 - cy) * inverse_focal;
        let mut lanes = Lanes::default();
        for i in 0..RUN {
            let u = ((x + i) as f32 - cx) * inverse_focal;
            let planar = meters[i].min(FARTHEST_M) / (u * u + v * v + 1.0).sqrt();
            (lanes.right[i], lanes.down[i], lanes.ahead[i]) = (u * planar, v * planar, planar);
        }
        self.sum(lanes)
    }

    /// The same of any rays, by the coordinates of their unit vectors.
    #[inline(always)]
    pub(crate) fn excess_along(
        &self,
        [right, down, ahead]: [&[f32; RUN]; 3],
        meters: &[f32; RUN],
    ) -> [f32; RUN] {
        let mut lanes = Lanes::default();
        for i in 0..RUN {
            let length = meters[i].min(FARTHEST_M);
            lanes.right[i] = right[i] * length;
            lanes.down[i] = down[i] * length;
            lanes.ahead[i] = ahead[i] * length;
        }
        self.sum(lanes)
    }

    #[inline(always)]
    fn sum(&self, mut lanes: Lanes) -> [f32; RUN] {
        // One wave after the other over all lanes: a loop over waves within each pixel would stay scalar.
        for wave in &self.waves {
            add(*wave, &mut lanes);
        }
        lanes.sum
    }
}

#[inline(always)]
fn row(range: &[f32], y: usize, stand_in: Option<f32>, rays: &Rays, path: &mut [f32]) {
    let (fills, filling) = (stand_in.is_some(), stand_in.unwrap_or(1.0));
    for (run, (range, path)) in range.chunks(RUN).zip(path.chunks_mut(RUN)).enumerate() {
        let mut given = [0.0f32; RUN];
        given[..range.len()].copy_from_slice(range);
        let mut meters = [0.0f32; RUN];
        for i in 0..RUN {
            let (valid, z) = masked(given[i]);
            meters[i] = if fills & !valid { filling } else { z };
        }
        let excess = rays.excess((run * RUN, y), &meters);
        for i in 0..path.len() {
            let (valid, _) = masked(given[i]);
            let z = meters[i];
            let length = (z + z.min(FARTHEST_M) * excess[i])
                .max(SHORTEST_M as f32)
                .min(f32::MAX);
            path[i] = if valid | fills { length } else { given[i] };
        }
    }
}

/// Adds the mean of one cosine along every path.
#[inline(always)]
fn add([qx, qy, qz, cosine, sine]: [f32; 5], lanes: &mut Lanes) {
    for i in 0..RUN {
        let half = qx * lanes.right[i] + qy * lanes.down[i] + qz * lanes.ahead[i];
        let (sin, cos) = sin_cos(half);
        let tiny = half.abs() < 1e-6;
        let share = sin / if tiny { 1.0 } else { half };
        let share = if tiny { 1.0 } else { share };
        lanes.sum[i] += (cosine * cos - sine * sin) * share;
    }
}

/// Sine and cosine of an angle of either sign; of large ones with the error that their f32 form has anyway.
#[inline(always)]
fn sin_cos(x: f32) -> (f32, f32) {
    /// Adding and subtracting it rounds to an integer, which ends up in the low bits.
    const ROUND: f32 = 12_582_912.0;
    /// π/2 in three parts (Cody and Waite 1980).
    const PARTS: [f32; 3] = [1.570_312_5, 4.837_513e-4, 7.549_79e-8];
    let rounded = x * std::f32::consts::FRAC_2_PI + ROUND;
    let n = rounded - ROUND;
    let r = ((x - n * PARTS[0]) - n * PARTS[1]) - n * PARTS[2];
    let (sin, cos) = small_sin_cos(r.max(-0.8).min(0.8));
    let quarter = rounded.to_bits();
    let (a, b) = if quarter & 1 == 0 { (sin, cos) } else { (cos, sin) };
    let sin = f32::from_bits(a.to_bits() ^ ((quarter & 2) << 30));
    let cos = f32::from_bits(b.to_bits() ^ ((quarter.wrapping_add(1) & 2) << 30));
    (sin, cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_agree_with_the_standard_library() {
        for step in -200_000..200_000 {
            let x = step as f32 * 1.3e-3;
            let (sin, cos) = sin_cos(x);
            let (expected_sin, expected_cos) = f64::from(x).sin_cos();
            assert!((f64::from(sin) - expected_sin).abs() < 4e-7, "{x}");
            assert!((f64::from(cos) - expected_cos).abs() < 4e-7, "{x}");
        }
        for huge in [1e6f32, -3e7, 1e9] {
            let (sin, cos) = sin_cos(huge);
            assert!(sin.abs() <= 1.001 && cos.abs() <= 1.001);
        }
    }
}
