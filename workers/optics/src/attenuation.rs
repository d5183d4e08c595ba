//! Attenuation along the ray: what arrives of the scene, and the veil that comes instead.
//!
//! `D = J exp(−β_D Z)`, `B = B∞ (1 − exp(−β_B Z))` (Jaffe 1990; with β_B apart from β_D: Akkaynak & Treibitz 2018). The f32
//! forms below have an absolute error under 3e-7 for light up to 1; 1 − exp is formed without cancellation, since naive
//! subtraction loses several per cent of the scattered share at centimetres.

/// `exp(−x)` for x ≥ 0, relative error below 3e-7; 0 from x = 87 on. Plain arithmetic, so that a loop over it vectorises.
#[inline(always)]
#[must_use]
pub fn exp_negative(x: f32) -> f32 {
    /// Added and taken away again, it rounds a float of this size to an integer.
    const ROUND: f32 = 12_582_912.0;
    const LN2_HIGH: f32 = 0.693_359_4;
    const LN2_LOW: f32 = -2.121_944_4e-4;
    let x = if x < 87.0 { x } else { 87.0 };
    let n = (x * std::f32::consts::LOG2_E + ROUND) - ROUND;
    // Between −ln2/2 and ln2/2.
    let r = (n * LN2_HIGH - x) + n * LN2_LOW;
    let p = 1.0
        + r * (1.0
            + r * (0.5 + r * (1.666_666_6e-1 + r * (4.166_579_6e-2 + r * (8.333_45e-3 + r * 1.388_9e-3)))));
    let scale = f32::from_bits(((127 - n as i32) as u32) << 23);
    if x < 87.0 { p * scale } else { 0.0 }
}

/// `1 − exp(−x)` for x ≥ 0, relative error below 1e-6 down to x = 0.
#[inline(always)]
#[must_use]
pub fn one_minus_exp_negative(x: f32) -> f32 {
    let small = x
        * (1.0
            - x * (0.5
                - x * (1.666_666_7e-1
                    - x * (4.166_666_8e-2 - x * (8.333_334e-3 - x * (1.388_889e-3 - x * 1.984_127e-4))))));
    if x < 0.5 { small } else { 1.0 - exp_negative(x) }
}

/// `w = exp(−G Z) − exp(−c Z)`, the share of the light that arrives scattered forward; 0 ≤ G ≤ c.
#[inline(always)]
#[must_use]
pub fn scattered_share(g: f32, excess: f32, z: f32) -> f32 {
    exp_negative(g * z) * one_minus_exp_negative(excess * z)
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn the_scattered_share_survives_at_a_centimetre() {
        let (c, g, z) = (0.4f32, 0.4f32 - 1e-4, 0.01f32);
        let excess = 1e-4f32;
        let expected = (-f64::from(g * z)).exp() * -(-f64::from(excess) * f64::from(z)).exp_m1();
        let share = f64::from(scattered_share(g, excess, z));
        assert!((share / expected - 1.0).abs() < 1e-5);
        let naive = f64::from((-g * z).exp() - (-c * z).exp());
        assert!(
            (naive / expected - 1.0).abs() > 1e-2,
            "subtraction would have done as well"
        );
    }
}
