//! Logarithm, cosine and exponential in plain f64 arithmetic, for vectorized loops with the same bits on every CPU.

use std::f64::consts::{LN_2, LOG2_E};

/// 2^52: added to a smaller number, it leaves the integer part in the low bits.
const WHOLE: f64 = 4_503_599_627_370_496.0;

/// Converts an integral value in 0..2^52 without the special cases of a cast.
#[inline(always)]
pub(crate) fn whole(x: f64) -> u64 {
    (x + WHOLE).to_bits() & ((1 << 52) - 1)
}

/// `ln x` of a normal number above 0: absolute error below 1e-11 for x in 2^-53..=1.
///
/// `x = 2^e m` with m in √½..√2; `ln m = 2 (s + s³/3 + s⁵/5 + …)`, `s = (m-1)/(m+1)`, |s| < 0.172.
#[inline(always)]
pub(crate) fn logarithm(x: f64) -> f64 {
    /// The bits of √½; smaller mantissas belong to the previous exponent.
    const HALF_BITS: u64 = 0x3fe6_a09e_667f_3bcd;
    let shifted = x.to_bits().wrapping_sub(HALF_BITS).wrapping_add(1023 << 52);
    let exponent = f64::from_bits(WHOLE.to_bits() | shifted >> 52) - (WHOLE + 1023.0);
    let mantissa = f64::from_bits((shifted & ((1 << 52) - 1)).wrapping_add(HALF_BITS));
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let z = s * s;
    let tail = z * (1.0 / 11.0 + z * (1.0 / 13.0 + z * (1.0 / 15.0)));
    let series = 1.0 + z * (1.0 / 3.0 + z * (1.0 / 5.0 + z * (1.0 / 7.0 + z * (1.0 / 9.0 + tail))));
    exponent * LN_2 + 2.0 * s * series
}

/// `cos 2πv` for v in 0..=1: absolute error below 1e-11.
///
/// Each quarter of a turn uses the series of sine or cosine within an eighth of a turn.
#[inline(always)]
pub(crate) fn cosine_of_turn(v: f64) -> f64 {
    use std::f64::consts::TAU;
    // cos 2πv = sin 2π(1/4 - v); t in -1/4..=1/4 with the same sine.
    let t = if v > 0.5 { v - 0.75 } else { 0.25 - v };
    let x = TAU * t;
    let z = x * x;
    let tail =
        z * (1.0 / 6_227_020_800.0 + z * (-1.0 / 1_307_674_368_000.0 + z * (1.0 / 355_687_428_096_000.0)));
    let middle = z * (1.0 / 362_880.0 + z * (-1.0 / 39_916_800.0 + tail));
    x * (1.0 + z * (-1.0 / 6.0 + z * (1.0 / 120.0 + z * (-1.0 / 5040.0 + middle))))
}

/// `e^{-x}` for x in 0..=700: relative error below 1e-15.
///
/// `-x = k ln 2 + r` with an integer k and |r| < 0.35; `e^r` by its series, 2^k by its bits.
#[inline(always)]
pub(crate) fn exponential_of_minus(x: f64) -> f64 {
    /// 1.5 × 2^52: adding it rounds to an integer in the low bits.
    const ROUNDING: f64 = 6_755_399_441_055_744.0;
    /// The first bits of ln 2, a multiple of 2^-33 exact for every k up to 2^20, and the rest.
    const LN_2_HIGH: f64 = 0.693_147_180_369_123_8;
    const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;
    let shifted = -x * LOG2_E + ROUNDING;
    let k = shifted - ROUNDING;
    let r = (-x - k * LN_2_HIGH) - k * LN_2_LOW;
    let tail = 1.0 / 3_628_800.0
        + r * (1.0 / 39_916_800.0 + r * (1.0 / 479_001_600.0 + r * (1.0 / 6_227_020_800.0)));
    let middle = 1.0 / 720.0 + r * (1.0 / 5040.0 + r * (1.0 / 40_320.0 + r * (1.0 / 362_880.0 + r * tail)));
    let series =
        1.0 + r * (1.0 + r * (0.5 + r * (1.0 / 6.0 + r * (1.0 / 24.0 + r * (1.0 / 120.0 + r * middle)))));
    f64::from_bits(series.to_bits().wrapping_add(shifted.to_bits() << 52))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Wrap-around of the mantissa.
    const SEAM: f64 = std::f64::consts::FRAC_1_SQRT_2;

    #[test]
    fn logarithms_agree_with_the_library() {
        let seams = [
            SEAM,
            SEAM.next_down(),
            SEAM.next_up(),
            0.5,
            1.0,
            f64::EPSILON / 2.0,
        ];
        let even = (1..100_000).map(|i| f64::from(i) * 1e-5);
        for x in seams.into_iter().chain(even) {
            let error = (logarithm(x) - libm::log(x)).abs();
            assert!(error < 1e-11, "{x}: {error:e}");
        }
    }

    #[test]
    fn cosines_agree_with_the_library() {
        for i in 0..=100_000 {
            let v = f64::from(i) * 1e-5;
            let error = (cosine_of_turn(v) - libm::cos(std::f64::consts::TAU * v)).abs();
            assert!(error < 1e-11, "{v}: {error:e}");
        }
    }

    #[test]
    fn exponentials_agree_with_the_library() {
        for i in 0..=100_000 {
            let x = f64::from(i) * 3e-4;
            let ratio = exponential_of_minus(x) / libm::exp(-x);
            assert!((ratio - 1.0).abs() < 1e-15, "{x}: {ratio}");
        }
        assert_eq!(exponential_of_minus(0.0), 1.0);
    }
}
