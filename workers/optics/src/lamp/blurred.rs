//! The blurred profile of a spot in f32, for a run of points.

use std::f32::consts::{FRAC_PI_2, PI};

use imaging::simd::{larger, smaller};
use imaging::vectorized;

use super::beam::Profile;
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

/// The cosines of the innermost rings, one or more of them, add up to six times a series in the square of the scale: its coefficients,
/// `(−1)^j Σ out^{2j}/(2j)!/6`, whose next term is below 2e-8 for rings within a right angle.
const COSINES: [[f32; 7]; RINGS] = [
    [
        1.66666667e-01,
        -1.58402204e-02,
        2.50912582e-04,
        -1.58980424e-06,
        5.39632489e-09,
        -1.13971967e-11,
        1.64121917e-14,
    ],
    [
        3.33333333e-01,
        -8.06550352e-02,
        4.45187280e-03,
        -1.10503588e-04,
        1.51808776e-06,
        -1.30840392e-08,
        7.70437643e-11,
    ],
    [
        5.00000000e-01,
        -2.42219661e-01,
        3.05550011e-02,
        -1.79744045e-03,
        5.99215142e-05,
        -1.27120774e-06,
        1.85559787e-08,
    ],
    [
        6.66666667e-01,
        -6.38886328e-01,
        1.87899446e-01,
        -2.67627590e-02,
        2.18197359e-03,
        -1.13504184e-04,
        4.06574513e-06,
    ],
    [
        8.33333333e-01,
        -1.88888633e+00,
        1.75039945e+00,
        -8.08012759e-01,
        2.11445366e-01,
        -3.49907363e-02,
        3.96738758e-03,
    ],
    [
        1.00000000e+00,
        -1.38055530e+01,
        1.43757344e+02,
        -6.77707781e+02,
        1.72872335e+03,
        -2.74644836e+03,
        2.97528511e+03,
    ],
];
/// Rings closer than this to the edge of the cone are computed point by point, rad.
const CLEAR: f32 = 1e-3;

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
///
/// Rings inside the cone at all angles have the mean of the profile at their middle; rings outside of it add 0.
pub(super) fn blurred(profile: &Profile, turned: &Turned, scales: &[Lanes; 3], to: &mut [Lanes; 3]) {
    let cone = profile.cone;
    let (mut cosines, mut ends) = ((0.0f32, 0.0f32), [(0.0f32, 0.0f32); 3]);
    vectorized!({
        cosines = extremes(&turned.along);
        for (ends, scale) in ends.iter_mut().zip(scales) {
            *ends = extremes(scale);
        }
    });
    let [nearest, farthest] =
        [cosines.1, cosines.0].map(|along| (along / profile.slope).clamp(-1.0, 1.0).acos());
    for ((scale, (least, most)), sum) in scales.iter().zip(ends).zip(to) {
        sum.fill(0.0);
        let is_inside = |out: &&f32| farthest + most * **out <= cone - CLEAR;
        let inside = OUT.iter().take_while(is_inside).count();
        if inside > 0 {
            vectorized!(add_inside(profile.offset, turned, scale, inside, sum));
        }
        for &out in &OUT[inside..] {
            let [least, most] = [least, most].map(|scale| smaller(scale * out, PI));
            let is_outside = nearest - most >= cone + CLEAR || least - farthest >= cone + CLEAR;
            if !is_outside {
                vectorized!(add_ring(profile.offset, turned, (scale, out), sum));
            }
        }
    }
}

/// The least and the greatest of some lanes.
#[inline(always)]
fn extremes(lanes: &Lanes) -> (f32, f32) {
    let (mut least, mut most) = (*lanes, *lanes);
    let mut half = RUN / 2;
    while half > 0 {
        for i in 0..half {
            least[i] = smaller(least[i], least[i + half]);
            most[i] = larger(most[i], most[i + half]);
        }
        half /= 2;
    }
    (least[0], most[0])
}

/// Adds the share of the innermost rings, which are inside the cone: the sum of their cosines, as a series.
#[inline(always)]
fn add_inside(offset: f32, turned: &Turned, scale: &Lanes, rings: usize, sum: &mut Lanes) {
    let [c0, c1, c2, c3, c4, c5, c6] = COSINES[rings - 1];
    for i in 0..RUN {
        let z = scale[i] * scale[i];
        let p = z.mul_add(z.mul_add(c6, c5), c4);
        let p = z.mul_add(z.mul_add(z.mul_add(p, c3), c2), c1);
        sum[i] += turned.along[i].mul_add(z.mul_add(p, c0), c0 * offset);
    }
}

/// Adds the share of one ring. Rings are the outer loop: unrolled within a loop over points they keep it scalar.
#[inline(always)]
fn add_ring(offset: f32, turned: &Turned, (scale, out): (&Lanes, f32), sum: &mut Lanes) {
    for i in 0..RUN {
        // As comparisons: `min` and `max` handle NaN, which needs three instructions instead of one.
        let ring = smaller(scale[i] * out, PI);
        let (sin_ring, cos_ring) = sin_cos_to_pi(ring);
        let middle = turned.along[i].mul_add(cos_ring, offset);
        let reach = turned.across[i] * sin_ring;
        // Two samples in opposite azimuths: max(m + t, 0) + max(m − t, 0) = m + max(|m|, t).
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
                let mut all = [[0.0; RUN]; 3];
                blurred(&profile, &turned, &[[scale as f32; RUN]; 3], &mut all);
                for (angle, fast) in angles.into_iter().zip(all[0]) {
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
