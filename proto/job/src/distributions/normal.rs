#![expect(
    clippy::excessive_precision,
    reason = "the coefficients stand as they are printed"
)]

const CENTER_NUMERATOR: [f64; 8] = [
    2.509_080_928_730_122_672_7e3,
    3.343_057_558_358_812_810_5e4,
    6.726_577_092_700_870_085_3e4,
    4.592_195_393_154_987_145_7e4,
    1.373_169_376_550_946_112_5e4,
    1.971_590_950_306_551_442_7e3,
    1.331_416_678_917_843_774_5e2,
    3.387_132_872_796_366_608_0,
];
const CENTER_DENOMINATOR: [f64; 8] = [
    5.226_495_278_852_854_561_0e3,
    2.872_908_573_572_194_267_4e4,
    3.930_789_580_009_271_061_0e4,
    2.121_379_430_158_659_586_7e4,
    5.394_196_021_424_751_107_7e3,
    6.871_870_074_920_579_083_0e2,
    4.231_333_070_160_091_125_2e1,
    1.0,
];
const SHOULDER_NUMERATOR: [f64; 8] = [
    7.745_450_142_783_414_076_40e-4,
    2.272_384_498_926_918_458_33e-2,
    2.417_807_251_774_506_117_70e-1,
    1.270_458_252_452_368_382_58,
    3.647_848_324_763_204_605_04,
    5.769_497_221_460_691_405_50,
    4.630_337_846_156_545_295_90,
    1.423_437_110_749_683_577_34,
];
const SHOULDER_DENOMINATOR: [f64; 8] = [
    1.050_750_071_644_416_843_24e-9,
    5.475_938_084_995_344_946_00e-4,
    1.519_866_656_361_645_719_66e-2,
    1.481_039_764_274_800_745_90e-1,
    6.897_673_349_851_000_045_50e-1,
    1.676_384_830_183_803_849_40,
    2.053_191_626_637_758_821_87,
    1.0,
];
const TAIL_NUMERATOR: [f64; 8] = [
    2.010_334_399_292_288_132_65e-7,
    2.711_555_568_743_487_578_15e-5,
    1.242_660_947_388_078_438_60e-3,
    2.653_218_952_657_612_309_30e-2,
    2.965_605_718_285_048_912_30e-1,
    1.784_826_539_917_291_335_80,
    5.463_784_911_164_114_369_90,
    6.657_904_643_501_103_777_20,
];
const TAIL_DENOMINATOR: [f64; 8] = [
    2.044_263_103_389_939_785_64e-15,
    1.421_511_758_316_445_888_70e-7,
    1.846_318_317_510_054_681_80e-5,
    7.868_691_311_456_132_591_00e-4,
    1.487_536_129_085_061_485_25e-2,
    1.369_298_809_227_358_053_10e-1,
    5.998_322_065_558_879_376_90e-1,
    1.0,
];

/// The standard normal quantile z with Φ(z) = p, for 0 < p < 1.
///
/// Algorithm AS 241, routine PPND16 (Wichura 1988, Applied Statistics 37, 477-484): relative accuracy about 1e-16.
/// Rational functions of q² for |q| ≤ 0.425 with q = p − 1/2, of sqrt(−ln min(p, 1−p)) beyond. Logarithm and root are
/// from `libm`, so the result is the same on every machine. p = 0 and p = 1 yield ∓∞; values outside 0..=1 yield NaN.
#[must_use]
pub fn normal_quantile(p: f64) -> f64 {
    let q = p - 0.5;
    if q.abs() <= 0.425 {
        let r = 0.180_625 - q * q;
        return ratio(&CENTER_NUMERATOR, &CENTER_DENOMINATOR, r, q);
    }
    let nearer_end = if q < 0.0 { p } else { 1.0 - p };
    if nearer_end == 0.0 {
        return f64::INFINITY.copysign(q);
    }
    let r = libm::sqrt(-libm::log(nearer_end));
    let z = if r <= 5.0 {
        ratio(&SHOULDER_NUMERATOR, &SHOULDER_DENOMINATOR, r - 1.6, 1.0)
    } else {
        ratio(&TAIL_NUMERATOR, &TAIL_DENOMINATOR, r - 5.0, 1.0)
    };
    if q < 0.0 { -z } else { z }
}

/// numerator(r) · factor / denominator(r), coefficients from the highest power down.
fn ratio(numerator: &[f64; 8], denominator: &[f64; 8], r: f64, factor: f64) -> f64 {
    let horner = |coefficients: &[f64; 8]| {
        coefficients
            .iter()
            .fold(0.0, |sum, coefficient| sum * r + coefficient)
    };
    horner(numerator) * factor / horner(denominator)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_printed_with_the_algorithm_are_met() {
        // Wichura 1988, checks of PPND16.
        for (p, z) in [
            (0.25, -0.674_489_750_196_081_7),
            (0.001, -3.090_232_306_167_813_5),
            (1e-20, -9.262_340_089_798_408),
        ] {
            assert!((normal_quantile(p) / z - 1.0_f64).abs() < 1e-15, "p = {p}");
        }
    }

    #[test]
    fn the_median_is_zero_and_the_sides_mirror() {
        assert_eq!(normal_quantile(0.5), 0.0);
        for p in [0.01, 0.0625, 0.25, 0.4] {
            assert!(
                (normal_quantile(p) + normal_quantile(1.0 - p)).abs() < 1e-14,
                "p = {p}"
            );
        }
    }

    #[test]
    fn it_rises_across_the_seams_of_its_pieces() {
        for seam in [0.075, 0.925, 1.389e-11] {
            let values: Vec<_> = [0.999_999, 1.0, 1.000_001]
                .map(|f| normal_quantile(seam * f))
                .to_vec();
            assert!(
                values[0] < values[1] && values[1] < values[2],
                "around {seam}: {values:?}"
            );
            assert!(values[2] - values[0] < 1e-4, "around {seam}: {values:?}");
        }
    }

    #[test]
    fn the_ends_are_infinite_and_outside_is_nan() {
        assert_eq!(normal_quantile(0.0), f64::NEG_INFINITY);
        assert_eq!(normal_quantile(1.0), f64::INFINITY);
        assert!(normal_quantile(-0.1).is_nan() && normal_quantile(1.1).is_nan());
    }
}
