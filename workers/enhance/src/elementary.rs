//! Natural logarithm, exponential and two roots, written for vectorized loops.
//!
//! Range reduction and polynomials of logarithm and exponential are those of the Cephes library (S. L. Moshier, 1992, `logf`
//! and `expf`). Without fused operations, every instruction set yields the same bits.

/// `ln(x)` for normal `x > 0`; within 2e-7 · max(1, |ln x|) of the exact value.
#[inline(always)]
pub(crate) fn ln(x: f32) -> f32 {
    // Split x = m · 2^e with m in [sqrt(1/2), sqrt(2)).
    const SQRT_HALF_BITS: i32 = 0x3f35_04f3;
    let offset = (x.to_bits() as i32).wrapping_sub(SQRT_HALF_BITS);
    let e = (offset >> 23) as f32;
    let m = f32::from_bits(((offset & 0x007f_ffff) + SQRT_HALF_BITS) as u32);
    let r = m - 1.0;
    let square = r * r;
    let mut p = 7.037_683_6e-2;
    p = p * r - 1.151_461e-1;
    p = p * r + 1.167_699_9e-1;
    p = p * r - 1.242_014_1e-1;
    p = p * r + 1.424_932_3e-1;
    p = p * r - 1.666_805_8e-1;
    p = p * r + 2.000_071_5e-1;
    p = p * r - 2.499_999_4e-1;
    p = p * r + 3.333_333e-1;
    // ln 2 in two parts, the first exact in few bits.
    let tail = p * r * square - 2.121_944_4e-4 * e - 0.5 * square;
    r + tail + 0.693_359_4 * e
}

/// `exp(x)` for `x <= 80`; within 2e-7 · max(1, exp x) of the exact value; clamped below -87 to exp(-87), about 1e-38.
#[inline(always)]
pub(crate) fn exp(x: f32) -> f32 {
    // Adding and subtracting 1.5 · 2^23 rounds to an integer and leaves it in the low bits.
    const ROUND: f32 = 12_582_912.0;
    let x = x.max(-87.0);
    let shifted = x * std::f32::consts::LOG2_E + ROUND;
    let n = shifted - ROUND;
    let r = x - n * 0.693_359_4 + n * 2.121_944_4e-4;
    let mut p = 1.987_569_1e-4;
    p = p * r + 1.398_2e-3;
    p = p * r + 8.333_452e-3;
    p = p * r + 4.166_58e-2;
    p = p * r + 1.666_666_5e-1;
    p = p * r + 5e-1;
    let power = p * (r * r) + r + 1.0;
    let scale = f32::from_bits((shifted.to_bits().wrapping_shl(23)).wrapping_add(0x3f80_0000));
    power * scale
}

/// `x^(1/3)` for normal `x > 0`; relative error at most 2e-7.
#[inline(always)]
pub(crate) fn cube_root(x: f32) -> f32 {
    let mut root = root_start(x, 1.0 / 3.0, CUBE_ROOT_SHIFT);
    for _ in 0..2 {
        let power = root * root * root;
        root += root * ((x - power) / (2.0 * power + x));
    }
    root
}

/// `x^(1/5)` for normal `x > 0`; relative error at most 2e-7.
#[inline(always)]
pub(crate) fn fifth_root(x: f32) -> f32 {
    let mut root = root_start(x, 1.0 / 5.0, FIFTH_ROOT_SHIFT);
    for _ in 0..2 {
        let square = root * root;
        let power = square * square * root;
        root += root * ((x - power) / (3.0 * power + 2.0 * x));
    }
    root
}

/// Start of Halley's iteration: the bits of x, scaled, are those of a root within 4 %. Each iteration cubes the relative error. It is
/// written as a correction, to lose fewer digits.
#[inline(always)]
fn root_start(x: f32, share: f32, shift: u32) -> f32 {
    // As in `exp`: the sum holds a rounded integer in its low bits. A cast from f32 would cost more than the iteration.
    const ROUND: f32 = 12_582_912.0;
    let scaled = (x.to_bits() >> 8) as i32 as f32 * share + ROUND;
    f32::from_bits((scaled.to_bits().wrapping_sub(ROUND.to_bits()) << 8).wrapping_add(shift))
}

/// The bits of 1 times 2/3 and 4/5, a little less, since straight lines between powers of two are above the root.
const CUBE_ROOT_SHIFT: u32 = 0x2a51_4067;
const FIFTH_ROOT_SHIFT: u32 = 0x32c8_16cd;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_within_their_bound() {
        for i in 0..=600_000 {
            let x = 2f32.powf(-40.0 + i as f32 * 1e-4);
            for (root, degree) in [(cube_root(x), 3), (fifth_root(x), 5)] {
                let off = f64::from(root).powi(degree) / f64::from(x) - 1.0;
                assert!(off.abs() <= 2e-7 * f64::from(degree), "{degree} {x}: {off}");
            }
        }
    }

    #[test]
    fn logarithm_is_within_two_units_of_the_last_place() {
        for i in 1..=300_000u32 {
            for x in [i as f32 / 255_000.0 + 1e-6, 1e-12 * i as f32, 3.0 * i as f32] {
                let exact = f64::from(x).ln();
                assert!(
                    (f64::from(ln(x)) - exact).abs() <= 2e-7 * exact.abs().max(1.0),
                    "ln {x}"
                );
            }
        }
    }

    #[test]
    fn exponential_is_within_its_bound_and_finite_far_below() {
        for i in 0..=300_000u32 {
            let x = -(i as f32) / 3e3;
            let exact = f64::from(x).exp();
            assert!((f64::from(exp(x)) - exact).abs() <= 2e-7, "exp {x}");
            let above = f64::from(x.max(-80.0)).abs();
            let off = f64::from(exp(above as f32)) / above.exp() - 1.0;
            assert!(off.abs() <= 2e-7, "exp {above}: {off}");
        }
        assert_eq!(exp(0.0), 1.0);
        assert!(exp(f32::MIN) < 1e-37);
    }
}
