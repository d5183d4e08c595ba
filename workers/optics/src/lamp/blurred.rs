//! The blurred profile of a spot in f32, of a run of places at once.

use std::f32::consts::{FRAC_PI_2, PI};

use imaging::simd::{larger, smaller};
use imaging::vectorized;

use super::multiple::{AZIMUTHS, RINGS};
use crate::turbidity::RUN;

/// [`rings`](super::multiple::rings) and the two cosines of [`azimuths`](super::multiple::azimuths) above 0.
const OUT: [f32; RINGS] = [
    0.435_984_7,
    0.881_917_1,
    1.392_399_2,
    2.181_742_4,
    3.872_983_4,
    11.958_261,
];
const TURN: [f32; AZIMUTHS / 2] = [0.923_879_5, 0.382_683_43];

type Lanes = [f32; RUN];

/// Angles to the axis of a spot with the profile `offset + slope cos`, by `slope` times their cosines and sines.
pub(super) struct Turned {
    pub(super) along: Lanes,
    pub(super) across: Lanes,
}

impl Turned {
    pub(super) fn new() -> Self {
        Self {
            along: [0.0; RUN],
            across: [0.0; RUN],
        }
    }
}

/// [`multiple::blurred`](super::multiple::blurred) of such a profile, at each angle and for the kernel of each scale.
pub(super) fn blurred(offset: f32, turned: &Turned, scale: &Lanes) -> Lanes {
    let mut sum = [0.0f32; RUN];
    for out in OUT {
        vectorized!(add_ring(offset, turned, (scale, out), &mut sum));
    }
    sum
}

/// Adds a share of what is met on a ring. Rings are the outer loop: unrolled within a loop over places they keep it scalar.
#[inline(always)]
fn add_ring(offset: f32, turned: &Turned, (scale, out): (&Lanes, f32), sum: &mut Lanes) {
    for i in 0..RUN {
        // As comparisons: `min` and `max` would care for NaN, which takes three instructions in place of one.
        let ring = smaller(scale[i] * out, PI);
        let (sin_ring, cos_ring) = sin_cos_to_pi(ring);
        let middle = turned.along[i].mul_add(cos_ring, offset);
        let reach = turned.across[i] * sin_ring;
        // Two places in opposite azimuths: max(m + t, 0) + max(m − t, 0) = m + max(|m|, t).
        let size = middle.abs();
        let [first, second] = TURN.map(|turn| middle + larger(size, reach * turn));
        sum[i] = (first + second).mul_add(1.0 / (RINGS * AZIMUTHS) as f32, sum[i]);
    }
}

/// Sine and cosine of an angle within 0..=π, to an error of 2e-7: as those of its distance from π/2.
#[inline(always)]
fn sin_cos_to_pi(angle: f32) -> (f32, f32) {
    let y = FRAC_PI_2 - angle;
    let z = y * y;
    let p = z.mul_add(2.605_107_7e-6, -1.980_901_7e-4);
    let p = z.mul_add(z.mul_add(p, 8.333_05e-3), -1.666_665_8e-1);
    let q = z.mul_add(-2.629_751_6e-7, 2.477_457_9e-5);
    let q = z.mul_add(z.mul_add(q, -1.388_865_2e-3), 4.166_666e-2);
    let sin = z.mul_add(z.mul_add(q, -0.5), 1.0);
    (sin, (y * z).mul_add(p, y))
}

#[cfg(test)]
mod tests {
    use super::super::beam::Beam;
    use super::super::multiple;
    use super::*;

    const STRAIGHT: f64 = std::f64::consts::PI;

    #[test]
    fn the_fast_form_is_the_reference() {
        for (single, double) in OUT.into_iter().zip(multiple::rings()) {
            assert!((f64::from(single) / double - 1.0).abs() < 1e-7, "{double}");
        }
        for (single, double) in TURN.into_iter().zip(multiple::azimuths()) {
            assert!((f64::from(single) - double).abs() < 1e-7, "{double}");
        }
        for cone_deg in [0.5, 10.0, 35.0, 90.0] {
            let beam = Beam::Spot {
                axis: [0.0, 0.0, 1.0],
                cos_cone: f64::to_radians(cone_deg).cos().max(0.0),
            };
            let profile = beam.single();
            for scale in [0.015, 0.037, 0.2, 0.7, 3.0, 1e9] {
                let angles: [f64; RUN] = std::array::from_fn(|i| STRAIGHT * i as f64 / (RUN - 1) as f64);
                let turned = Turned {
                    along: angles.map(|angle| profile.slope * angle.cos() as f32),
                    across: angles.map(|angle| profile.slope * angle.sin() as f32),
                };
                let all = blurred(profile.offset, &turned, &[scale as f32; RUN]);
                for (angle, fast) in angles.into_iter().zip(all) {
                    let exact = multiple::blurred(beam, scale, |_| angle.cos());
                    let error = (f64::from(fast) - exact).abs();
                    assert!(
                        error < 1e-6 + 4e-7 * beam.slope(),
                        "{cone_deg} {angle} {scale}: {fast} for {exact}"
                    );
                }
            }
        }
    }

    #[test]
    fn sine_and_cosine_agree_with_the_standard_library() {
        for step in 0..=20_000 {
            let angle = (STRAIGHT * f64::from(step) / 20_000.0) as f32;
            let (sin, cos) = sin_cos_to_pi(angle);
            let (expected_sin, expected_cos) = f64::from(angle).sin_cos();
            let error = (f64::from(sin) - expected_sin)
                .abs()
                .max((f64::from(cos) - expected_cos).abs());
            assert!(error < 2e-7, "{angle}: {error:e}");
        }
    }
}
