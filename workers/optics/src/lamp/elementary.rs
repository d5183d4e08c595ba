//! Angles in plain f32 arithmetic, so that loops over them vectorise and give the same bits on every CPU.
//!
//! The polynomials are those of Moshier's Cephes library (1989), relative error below 2e-7.

use std::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_4, PI};

/// tan(π/8) and tan(3π/8), between which the angle is taken from π/4.
const LOW: f32 = 0.414_213_57;
const HIGH: f32 = 2.414_213_7;

/// The angle in 0..=π/2 whose tangent is `y / x`; both at least 0, not both 0. `y` may be infinite.
#[inline(always)]
pub(super) fn angle(y: f32, x: f32) -> f32 {
    let steep = y > HIGH * x;
    let middle = y > LOW * x;
    let base = if middle { FRAC_PI_4 } else { 0.0 };
    let base = if steep { FRAC_PI_2 } else { base };
    let (top, bottom) = if middle { (y - x, y + x) } else { (y, x) };
    let (top, bottom) = if steep { (-x, y) } else { (top, bottom) };
    let t = top / bottom;
    let z = t * t;
    base + (((8.053_744_5e-2 * z - 1.387_768_6e-1) * z + 1.997_771_1e-1) * z - 3.333_295e-1) * z * t + t
}

/// The angle in −π..=π of the point (x, y), not both 0.
#[inline(always)]
pub(super) fn full_angle(y: f32, x: f32) -> f32 {
    let sharp = angle(y.abs(), x.abs());
    let upper = if x < 0.0 { PI - sharp } else { sharp };
    if y < 0.0 { -upper } else { upper }
}

/// Sine and cosine of an angle within ±π/4.
#[inline(always)]
pub(crate) fn small_sin_cos(x: f32) -> (f32, f32) {
    let z = x * x;
    let sin = ((-1.951_529_6e-4 * z + 8.332_161e-3) * z - 1.666_665_5e-1) * z * x + x;
    let cos = ((2.443_315_7e-5 * z - 1.388_731_6e-3) * z + 4.166_664_6e-2) * z * z - 0.5 * z + 1.0;
    (sin, cos)
}

/// Sine and cosine of an angle within 0..=π/2.
#[inline(always)]
pub(super) fn sin_cos(x: f32) -> (f32, f32) {
    let (sin, cos) = small_sin_cos(x - FRAC_PI_4);
    ((sin + cos) * FRAC_1_SQRT_2, (cos - sin) * FRAC_1_SQRT_2)
}

/// `exp(−x)` for x ≥ 0, relative error below 3e-7; from x = 87 on it stays at 2e-38. The polynomial is the best of the fifth
/// degree for the relative error on ±ln2/2.
#[inline(always)]
pub(super) fn fade(x: f32) -> f32 {
    /// Added and taken away again, it rounds a float of this size to an integer, which then stands in its low bits.
    const ROUND: f32 = 12_582_912.0;
    const LN2_HIGH: f32 = 0.693_359_4;
    const LN2_LOW: f32 = -2.121_944_4e-4;
    let x = x.min(87.0);
    let rounded = x * std::f32::consts::LOG2_E + ROUND;
    let n = rounded - ROUND;
    let r = (n * LN2_HIGH - x) + n * LN2_LOW;
    let p = 0.999_999_7 + r * (0.499_988_95 + r * (0.166_675_75 + r * (4.191_538_2e-2 + r * 8.297_655e-3)));
    let exponent = (127 + ROUND.to_bits()).wrapping_sub(rounded.to_bits());
    (1.0 + r * p) * f32::from_bits(exponent << 23)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fading_agrees_with_the_standard_library() {
        for step in 0..200_000 {
            let x = step as f32 * 4e-4;
            let expected = (-f64::from(x)).exp();
            let error = (f64::from(fade(x)) - expected).abs();
            assert!(error <= 3e-7 * expected, "exp(-{x}): {error:e}");
        }
        assert!(fade(0.0) == 1.0 && fade(1e9) < 2e-38 && fade(f32::INFINITY) < 2e-38);
    }

    /// A few units in the last place of numbers up to π.
    const ROUNDING: f64 = 5e-7;

    #[test]
    fn angles_agree_with_the_standard_library() {
        for step in 0..=40_000 {
            let exact = f64::from(step - 20_000) / 20_000.0 * std::f64::consts::PI;
            for length in [1e-3, 1.0, 50.0] {
                let (y, x) = ((exact.sin() * length) as f32, (exact.cos() * length) as f32);
                let expected = f64::from(y).atan2(f64::from(x));
                assert!(
                    (f64::from(full_angle(y, x)) - expected).abs() < ROUNDING,
                    "{exact}"
                );
            }
            let sharp = exact.abs() / 2.0;
            let (sin, cos) = sin_cos(sharp as f32);
            let (expected_sin, expected_cos) = f64::from(sharp as f32).sin_cos();
            assert!((f64::from(sin) - expected_sin).abs() < ROUNDING, "{sharp}");
            assert!((f64::from(cos) - expected_cos).abs() < ROUNDING, "{sharp}");
        }
        assert_eq!(angle(f32::INFINITY, 1.0), FRAC_PI_2);
        assert_eq!(angle(0.0, 2.0), 0.0);
    }
}
