//! The blurred profile of a spot in f32, where loops over it vectorize.

use std::f32::consts::FRAC_PI_2;

use super::multiple::{AZIMUTHS, RINGS};
use crate::elementary::sin_cos;

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

/// [`blurred`](super::multiple::blurred) of the profile `offset + slope cos`, by cosine and sine of the angle to the axis.
#[inline(always)]
pub(super) fn blurred([slope, offset]: [f32; 2], [cos, sin]: [f32; 2], scale: f32) -> f32 {
    // As comparisons: `max` would care for NaN, which takes three instructions in place of one.
    let positive = |v: f32| if v > 0.0 { v } else { 0.0 };
    let (along, across) = (slope * cos, slope * sin);
    let mut sum = 0.0f32;
    for out in OUT {
        // By half the angle, which stays below π/2.
        let half = scale * (0.5 * out);
        let (half_sin, half_cos) = sin_cos(if half < FRAC_PI_2 { half } else { FRAC_PI_2 });
        let (sin_ring, cos_ring) = (
            2.0 * half_sin * half_cos,
            (2.0 * half_sin).mul_add(-half_sin, 1.0),
        );
        let (middle, reach) = (along.mul_add(cos_ring, offset), across * sin_ring);
        for turn in TURN {
            sum += positive(reach.mul_add(turn, middle)) + positive(reach.mul_add(-turn, middle));
        }
    }
    sum * (1.0 / (RINGS * AZIMUTHS) as f32)
}

#[cfg(test)]
mod tests {
    use super::super::beam::Beam;
    use super::super::multiple;
    use super::*;

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
            for degrees in 0..=180 {
                let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
                for scale in [0.015, 0.037, 0.2, 0.7, 3.0, 1e9] {
                    let exact = multiple::blurred(beam, scale, |_| cos);
                    let fast = blurred(
                        [profile.slope, profile.offset],
                        [cos as f32, sin as f32],
                        scale as f32,
                    );
                    let error = (f64::from(fast) - exact).abs();
                    assert!(
                        error < 1e-6 + 4e-7 * beam.slope(),
                        "{cone_deg} {degrees} {scale}: {fast} for {exact}"
                    );
                }
            }
        }
    }
}
