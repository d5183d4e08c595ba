//! Angles and exponentials in plain f32 arithmetic, so that loops over them vectorize. Fused multiply-adds are explicit: they round
//! only one time with or without hardware support, so the bits are the same on every CPU.
//!
//! The polynomials are those of Moshier's Cephes library (1989), relative error below 2e-7.

use std::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_4, PI};

/// tan(π/8) and tan(3π/8), the limits of the reduction by π/4.
const LOW: f32 = 0.414_213_57;
const HIGH: f32 = 2.414_213_7;

/// The angle in 0..=π/2 whose tangent is `y / x`; both at least 0, not both 0. `y` may be infinite.
#[inline(always)]
pub(crate) fn angle(y: f32, x: f32) -> f32 {
    let steep = y > HIGH * x;
    let middle = y > LOW * x;
    let base = if middle { FRAC_PI_4 } else { 0.0 };
    let base = if steep { FRAC_PI_2 } else { base };
    let (top, bottom) = if middle { (y - x, y + x) } else { (y, x) };
    let (top, bottom) = if steep { (-x, y) } else { (top, bottom) };
    let t = top / bottom;
    let z = t * t;
    let p = z.mul_add(z.mul_add(8.053_744_5e-2, -1.387_768_6e-1), 1.997_771_1e-1);
    base + (z.mul_add(p, -3.333_295e-1) * z).mul_add(t, t)
}

/// The angle in −π..=π of the point (x, y), not both 0.
#[inline(always)]
pub(crate) fn full_angle(y: f32, x: f32) -> f32 {
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
pub(crate) fn sin_cos(x: f32) -> (f32, f32) {
    let (sin, cos) = small_sin_cos(x - FRAC_PI_4);
    ((sin + cos) * FRAC_1_SQRT_2, (cos - sin) * FRAC_1_SQRT_2)
}

/// Nats in one halving: `exp(−c x)` is 2 to the power of minus this times c x.
pub(crate) const HALVINGS: f32 = std::f32::consts::LOG2_E;

/// `2^(−rate x)` for rate x ≥ 0, relative error below 3e-7; 0 from 126 halvings on, and for NaN. With `rate` = c log₂ e it is
/// `exp(−c x)`. The polynomial is the best of the fifth degree for the relative error within half a step.
#[inline(always)]
pub(crate) fn fade(rate: f32, x: f32) -> f32 {
    /// Adding and subtracting it rounds a float of this size to an integer, which ends up in its low bits.
    const ROUND: f32 = 12_582_912.0;
    const MOST: f32 = ROUND + 126.0;
    let rounded = rate.mul_add(x, ROUND);
    let r = (-rate).mul_add(x, rounded - ROUND);
    let p = r.mul_add(1.32764719e-03, 9.67554134e-03);
    let p = r.mul_add(r.mul_add(p, 5.55071336e-02), 2.40221198e-01);
    let p = r.mul_add(r.mul_add(p, 6.93146973e-01), 1.0);
    // The bits above the integer are shifted out.
    let bits = p.to_bits().wrapping_sub(rounded.to_bits() << 23);
    if rounded < MOST { f32::from_bits(bits) } else { 0.0 }
}

/// `x^0.7` for x from 0 to 2^40, relative error below 2e-6.
#[inline(always)]
pub(crate) fn power_0_7(x: f32) -> f32 {
    /// 0.7 times the most halvings.
    const MOST: f32 = 28.0;
    const SCALE: f32 = 268_435_456.0;
    let bits = x.to_bits();
    let whole = (bits >> 23) as i32 - 127;
    let part = f32::from_bits(bits & 0x007f_ffff | 0x3f80_0000);
    let high = part > std::f32::consts::SQRT_2;
    let part = if high { 0.5 * part } else { part };
    let whole = if high { whole + 1 } else { whole } as f32;
    let m = part - 1.0;
    let p = m.mul_add(7.037_683_6e-2, -1.151_461e-1);
    let p = m.mul_add(m.mul_add(p, 1.167_699_9e-1), -1.242_014_1e-1);
    let p = m.mul_add(m.mul_add(p, 1.424_932_3e-1), -1.666_805_7e-1);
    let p = m.mul_add(m.mul_add(p, 2.000_071_5e-1), -2.499_999_4e-1);
    let p = m.mul_add(p, 3.333_333_1e-1);
    let square = m * m;
    let log = (square * m).mul_add(p, (-0.5f32).mul_add(square, m));
    let halvings = 0.7 * log.mul_add(HALVINGS, whole);
    SCALE * fade(1.0, MOST - halvings)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_power_agrees_with_the_standard_library() {
        for step in 0..60_000 {
            let x = 1e-4 * (step as f32 * 4e-4).exp();
            let exact = f64::from(x).powf(0.7);
            let error = (f64::from(power_0_7(x)) - exact).abs();
            assert!(error <= 2e-6 * exact, "{x}: {error:e}");
        }
        assert!(power_0_7(0.0) < 1e-20);
    }

    #[test]
    fn fading_agrees_with_the_standard_library() {
        for step in 0..200_000 {
            let x = step as f32 * 4.3e-4;
            let expected = (-f64::from(HALVINGS) * f64::from(x)).exp2();
            let error = (f64::from(fade(HALVINGS, x)) - expected).abs();
            assert!(error <= 3e-7 * expected, "exp(-{x}): {error:e}");
        }
        for x in [87.4, 1e9, f32::INFINITY, f32::NAN] {
            assert_eq!(fade(HALVINGS, x), 0.0);
        }
        assert_eq!((fade(HALVINGS, 0.0), fade(0.0, 7.0)), (1.0, 1.0));
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
