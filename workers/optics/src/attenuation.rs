//! Attenuation along the ray: transmitted scene light and veil.
//!
//! `D = J exp(−β_D Z)`, `B = B∞ (1 − exp(−β_B Z))` (Jaffe 1990; with β_B apart from β_D: Akkaynak & Treibitz 2018). The f32
//! functions below have an absolute error under 3e-7 for light up to 1; 1 − exp is formed without cancellation, since plain
//! subtraction loses several per cent of the scattered share at centimeters. They use plain additions and multiplications without
//! fused steps, so the bits are the same on every CPU.

use imaging::{Plane, vectorized};

use crate::range::is_hole;

/// Beyond this `exp(−x)` is 0 in f32 arithmetic.
pub(crate) const OPAQUE: f32 = 87.0;
const SHORTEST_M: f32 = crate::range::SHORTEST_M as f32;

/// `exp(−x)` for x ≥ 0, relative error below 3e-7; 0 from x = 87 on. Plain arithmetic, so that a loop over it vectorizes.
#[inline(always)]
#[must_use]
pub fn exp_negative(x: f32) -> f32 {
    /// Adding and subtracting it rounds a float of this size to an integer, which ends up in its low bits.
    const ROUND: f32 = 12_582_912.0;
    const LN2_HIGH: f32 = 0.693_359_4;
    const LN2_LOW: f32 = -2.121_944_4e-4;
    let clear = x < OPAQUE;
    let x = if clear { x } else { OPAQUE };
    let rounded = x * std::f32::consts::LOG2_E + ROUND;
    let n = rounded - ROUND;
    // Between −ln2/2 and ln2/2.
    let r = (n * LN2_HIGH - x) + n * LN2_LOW;
    let p = 1.0
        + r * (1.0
            + r * (0.5 + r * (1.666_666_6e-1 + r * (4.166_579_6e-2 + r * (8.333_45e-3 + r * 1.388_9e-3)))));
    let exponent = (127 + ROUND.to_bits()).wrapping_sub(rounded.to_bits());
    let scale = f32::from_bits(exponent << 23);
    if clear { p * scale } else { 0.0 }
}

/// `1 − exp(−x)` for x ≥ 0, relative error below 1e-6 down to x = 0.
#[inline(always)]
#[must_use]
pub fn one_minus_exp_negative(x: f32) -> f32 {
    one_minus(x, exp_negative(x))
}

/// The same, given `exp(−x)`.
#[inline(always)]
fn one_minus(x: f32, exp: f32) -> f32 {
    // Both are computed, so that the choice compiles to a selection instead of a branch.
    let small = x
        * (1.0
            - x * (0.5
                - x * (1.666_666_7e-1
                    - x * (4.166_666_8e-2 - x * (8.333_334e-3 - x * (1.388_889e-3 - x * 1.984_127e-4))))));
    if x < 0.5 { small } else { 1.0 - exp }
}

/// `w = exp(−G Z) − exp(−c Z)`, the share of the light that arrives scattered forward; 0 ≤ G ≤ c, `excess` = c − G.
#[inline(always)]
#[must_use]
pub fn scattered_share(g: f32, excess: f32, z: f32) -> f32 {
    exp_negative(g * z) * one_minus_exp_negative(excess * z)
}

/// Whether the range is one, and a range to compute with in either case: finite and not negative.
#[inline(always)]
#[expect(
    clippy::manual_clamp,
    reason = "NaN has to become 0, and stays NaN through clamp"
)]
pub(crate) fn masked(z: f32) -> (bool, f32) {
    // A short circuit or a constant for a hole would become a branch and prevent vectorization.
    let (far_enough, finite) = (z >= SHORTEST_M, z <= f32::MAX);
    (far_enough & finite, z.max(0.0).min(f32::MAX))
}

/// Coefficients of one channel in f32.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Channel {
    /// Factor of the radiance, 1 without ambient light.
    pub(crate) gain: f32,
    /// β_D.
    pub(crate) direct: f32,
    /// β_B.
    pub(crate) backscatter: f32,
    /// B∞.
    pub(crate) veil: f32,
}

/// Attenuated planes of one channel, each of the length of the frame.
pub(crate) struct Attenuated<'a> {
    /// D.
    pub(crate) direct: &'a mut [f32],
    /// B.
    pub(crate) veil: &'a mut [f32],
    /// D + B.
    pub(crate) image: &'a mut [f32],
}

/// `D = J exp(−β_D Z)` and `B = B∞ (1 − exp(−β_B Z))`. At a hole the path is infinite: if the water attenuates, D is 0 and B is B∞;
/// otherwise D is J and B is 0.
pub(crate) fn attenuate(radiance: &[f32], range: &[f32], channel: Channel, mut to: Attenuated<'_>) {
    let Channel {
        direct, backscatter, ..
    } = channel;
    if direct == backscatter {
        // One exponential serves both.
        let shares = |z| {
            let arriving = exp_negative(direct * z);
            [arriving, one_minus(direct * z, arriving)]
        };
        vectorized!(layers(radiance, range, channel, &mut to, shares));
    } else {
        let shares = |z| [exp_negative(direct * z), one_minus_exp_negative(backscatter * z)];
        vectorized!(layers(radiance, range, channel, &mut to, shares));
    }
}

#[inline(always)]
fn layers(
    radiance: &[f32],
    range: &[f32],
    channel: Channel,
    to: &mut Attenuated<'_>,
    shares: impl Fn(f32) -> [f32; 2],
) {
    let Channel {
        gain,
        direct,
        backscatter,
        veil,
    } = channel;
    let far = [
        f32::from(u8::from(direct == 0.0)),
        f32::from(u8::from(backscatter > 0.0)),
    ];
    let layers = to
        .direct
        .iter_mut()
        .zip(to.veil.iter_mut())
        .zip(to.image.iter_mut());
    for (((d, b), i), (&j, &z)) in layers.zip(radiance.iter().zip(range)) {
        let (valid, z) = masked(z);
        let [arriving, veiling] = shares(z);
        *d = j * gain * if valid { arriving } else { far[0] };
        *b = veil * if valid { veiling } else { far[1] };
        *i = *d + *b;
    }
}

/// `U = L w`: the spread part of the light of `source`; 0 at a hole.
#[inline(always)]
pub(crate) fn spread_light(source: &[f32], range: &[f32], [gain, g, excess]: [f32; 3], light: &mut [f32]) {
    for (u, (&l, &z)) in light.iter_mut().zip(source.iter().zip(range)) {
        let (valid, z) = masked(z);
        let spread = l * gain * scattered_share(g, excess, z);
        *u = if valid { spread } else { 0.0 };
    }
}

/// `1 − exp(−Z / scale_m)` of each pixel: 0 at the camera, 1 far away and at pixels without a surface.
#[must_use]
pub fn faded(range: &Plane<f32>, scale_m: f32) -> Plane<f32> {
    let mut out = range.clone();
    let per_m = 1.0 / scale_m;
    vectorized!(fade(out.data_mut(), per_m));
    out
}

#[inline(always)]
fn fade(range: &mut [f32], per_m: f32) {
    for z in range {
        let far = if is_hole(*z) { OPAQUE } else { *z * per_m };
        *z = one_minus_exp_negative(far);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_far_or_has_no_surface_fades_to_one() {
        let range = [0.002, 1.0, 4.0, 40.0, 1e6, 0.0, -1.0, f32::NAN, f32::INFINITY];
        let found = faded(&Plane::new(9, 1, range.to_vec()).unwrap(), 4.0);
        for (&z, &found) in range.iter().zip(found.data()) {
            let is_surface = z.is_finite() && z > 0.0;
            let expected = if is_surface {
                -(-f64::from(z) / 4.0).exp_m1()
            } else {
                1.0
            };
            assert!((f64::from(found) - expected).abs() < 3e-7, "{z} m: {found}");
        }
    }

    #[test]
    fn the_exponential_is_exact_to_three_parts_in_ten_million() {
        for step in 0..200_000 {
            let x = step as f32 * 4e-4;
            let expected = (-f64::from(x)).exp();
            let error = (f64::from(exp_negative(x)) - expected).abs();
            assert!(error <= 3e-7 * expected, "exp(-{x}): {error:e}");
            let expected = -(-f64::from(x)).exp_m1();
            let error = (f64::from(one_minus_exp_negative(x)) - expected).abs();
            assert!(error <= 1e-6 * expected, "1 - exp(-{x}): {error:e}");
        }
        assert_eq!(
            (exp_negative(0.0), exp_negative(1e9), exp_negative(f32::INFINITY)),
            (1.0, 0.0, 0.0)
        );
    }

    #[test]
    fn the_scattered_share_keeps_its_digits_at_a_centimeter() {
        let (g, c, z) = (0.1, 0.1001, 0.01);
        let expected = f64::exp(-g * z) * -(-(c - g) * z).exp_m1();
        let share = f64::from(scattered_share(g as f32, (c - g) as f32, z as f32));
        assert!((share / expected - 1.0).abs() < 1e-6);
    }

    fn attenuated(radiance: &[f32], range: &[f32], channel: Channel) -> [Vec<f32>; 2] {
        let [mut direct, mut veil, mut image] = [(); 3].map(|()| vec![0.0; range.len()]);
        let layers = Attenuated {
            direct: &mut direct,
            veil: &mut veil,
            image: &mut image,
        };
        attenuate(radiance, range, channel, layers);
        [direct, veil]
    }

    const WATER: Channel = Channel {
        gain: 1.0,
        direct: 0.3,
        backscatter: 0.2,
        veil: 0.7,
    };

    #[test]
    fn holes_of_every_kind_show_only_the_veil() {
        let range = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -1e30, 1e-4];
        assert_eq!(attenuated(&[0.5; 6], &range, WATER), [[0.0; 6], [0.7; 6]]);
        let clear = Channel {
            direct: 0.0,
            backscatter: 0.0,
            ..WATER
        };
        assert_eq!(attenuated(&[0.5; 6], &range, clear), [[0.5; 6], [0.0; 6]]);
        let mut light = [1.0; 6];
        spread_light(&[0.5; 6], &range, [1.0, 0.1, 0.2], &mut light);
        assert_eq!(light, [0.0; 6]);
    }

    #[test]
    fn at_long_range_only_the_veil_remains_and_at_none_only_the_scene() {
        assert_eq!(attenuated(&[0.5], &[1e6], WATER), [[0.0], [0.7]]);
        let [direct, veil] = attenuated(&[0.5], &[0.001], WATER);
        assert!((direct[0] - 0.5).abs() < 2e-4 && veil[0] < 2e-4);
    }

    #[test]
    fn one_exponential_serves_equal_coefficients_alike() {
        let range: Vec<f32> = (0..500).map(|i| 0.02 * i as f32 - 0.1).collect();
        let radiance = vec![0.8; range.len()];
        let equal = Channel {
            backscatter: 0.3,
            ..WATER
        };
        let nearly = Channel {
            backscatter: f32::from_bits(0.3f32.to_bits() + 1),
            ..WATER
        };
        let [one, other] = [equal, nearly].map(|channel| attenuated(&radiance, &range, channel));
        for (one, other) in one.iter().flatten().zip(other.iter().flatten()) {
            assert!((one - other).abs() < 3e-7, "{one} and {other}");
        }
    }
}
