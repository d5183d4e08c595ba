//! CIEDE2000 to the clean picture: the mean color difference of corresponding pixels (CIE 142-2001; Sharma, Wu and
//! Dalal 2005, "The CIEDE2000 color-difference formula: implementation notes", eq. 2-22), with k_L = k_C = k_H = 1.
//!
//! `ΔE00 = sqrt((ΔL'/S_L)² + (ΔC'/S_C)² + (ΔH'/S_H)² + R_T (ΔC'/S_C)(ΔH'/S_H))` of two colors in CIE Lab. 1 is about
//! the smallest visible difference, black to white is 100; 0 for equal pictures.
//!
//! The fast variant needs no trigonometric functions: sines and cosines of hues come from the colors, those of
//! multiples from angle sums, and the mean hue is the direction half-way between the two. The only angle in the formula
//! is a polynomial. Opposite hues have no mean; 0 is used.

use imaging::simd::larger;
use imaging::{Rgb8, lab, vectorized};

use crate::linear::LINEAR;
use crate::work::MetricInput;

/// Mean difference to the clean picture.
pub(crate) fn ciede2000(work: &MetricInput) -> f64 {
    mean(work.picture(), work.clean())
}

fn mean(picture: &Rgb8, clean: &Rgb8) -> f64 {
    let mut sum = 0.0;
    vectorized!(sum = total(picture.data(), clean.data()));
    sum / (picture.data().len() / 3) as f64
}

/// Pixels per block.
const BLOCK: usize = 32;

#[inline(always)]
fn total(codes: &[u8], clean: &[u8]) -> f64 {
    let linear: &[f64; 256] = &LINEAR;
    // One sum per position in a block, added in order: the same on every machine.
    let mut sums = [0.0f64; BLOCK];
    for (codes, clean) in codes.chunks(3 * BLOCK).zip(clean.chunks(3 * BLOCK)) {
        // A closure of `map` would be compiled without vector instructions.
        let seen = lab::of_codes::<BLOCK>(codes, [linear; 3]);
        let wanted = lab::of_codes::<BLOCK>(clean, [linear; 3]);
        for x in 0..BLOCK {
            let seen = [seen[0][x], seen[1][x], seen[2][x]];
            let wanted = [wanted[0][x], wanted[1][x], wanted[2][x]];
            sums[x] += difference(seen, wanted);
        }
    }
    sums.iter().sum()
}

const POW_25_7: f64 = 6_103_515_625.0;

/// ΔE00 of two colors.
#[inline(always)]
fn difference([l1, a1, b1]: [f64; 3], [l2, a2, b2]: [f64; 3]) -> f64 {
    let mean_chroma = 0.5 * ((a1 * a1 + b1 * b1).sqrt() + (a2 * a2 + b2 * b2).sqrt());
    let stretch = 1.5 - 0.5 * chroma_share(mean_chroma);
    let (a1, a2) = (stretch * a1, stretch * a2);
    let (c1, c2) = ((a1 * a1 + b1 * b1).sqrt(), (a2 * a2 + b2 * b2).sqrt());

    // 2 sqrt(C1 C2) sin(Δh / 2) from the cross and the dot product, in the form without cancellation.
    let (cross, dot) = (a1 * b2 - a2 * b1, a1 * a2 + b1 * b2);
    let product = c1 * c2;
    let near = cross * (2.0 / larger(product + dot, 1e-300)).sqrt();
    let far = larger(2.0 * (product - dot), 0.0).sqrt();
    let far = if cross < 0.0 { -far } else { far };
    let hue = if dot > 0.0 { near } else { far };

    // The direction half-way between the hues.
    let (n1, n2) = (1.0 / larger(c1, 1e-300), 1.0 / larger(c2, 1e-300));
    let (x, y) = (a1 * n1 + a2 * n2, b1 * n1 + b2 * n2);
    let length = (x * x + y * y).sqrt();
    let known = length > 1e-9;
    let scale = 1.0 / if known { length } else { 1.0 };
    let (c, s) = (
        if known { x * scale } else { 1.0 },
        if known { y * scale } else { 0.0 },
    );

    let (c2h, s2h) = (c * c - s * s, 2.0 * c * s);
    let (c3h, s3h) = (c2h * c - s2h * s, s2h * c + c2h * s);
    let (c4h, s4h) = (c2h * c2h - s2h * s2h, 2.0 * c2h * s2h);
    let t = 1.0 - 0.17 * (c * COS_30 + s * SIN_30) + 0.24 * c2h + 0.32 * (c3h * COS_6 - s3h * SIN_6)
        - 0.20 * (c4h * COS_63 + s4h * SIN_63);

    let lightness = 0.5 * (l1 + l2) - 50.0;
    let chroma = 0.5 * (c1 + c2);
    let s_l = 1.0 + 0.015 * lightness * lightness / (20.0 + lightness * lightness).sqrt();
    let s_c = 1.0 + 0.045 * chroma;
    let s_h = 1.0 + 0.015 * chroma * t;
    let r_t = -2.0 * chroma_share(chroma) * sine_of_rotation(c, s);
    let (dl, dc, dh) = ((l2 - l1) / s_l, (c2 - c1) / s_c, hue / s_h);
    larger(dl * dl + dc * dc + dh * dh + r_t * dc * dh, 0.0).sqrt()
}

const COS_30: f64 = 0.866_025_403_784_438_6;
const SIN_30: f64 = 0.5;
const COS_6: f64 = 0.994_521_895_368_273_3;
const SIN_6: f64 = 0.104_528_463_267_653_47;
const COS_63: f64 = 0.453_990_499_739_546_8;
const SIN_63: f64 = 0.891_006_524_188_367_9;
const COS_275: f64 = 0.087_155_742_747_658_17;
const SIN_275: f64 = -0.996_194_698_091_745_5;

/// `sqrt(C⁷ / (C⁷ + 25⁷))`.
#[inline(always)]
fn chroma_share(chroma: f64) -> f64 {
    let square = chroma * chroma;
    let power = square * square * square * chroma;
    (power / (power + POW_25_7)).sqrt()
}

/// `sin(2 Δθ)` with `Δθ = 30° exp(-((h - 275°) / 25°)²)`, for the cosine and sine of h in 0°..360°.
#[inline(always)]
fn sine_of_rotation(c: f64, s: f64) -> f64 {
    // The angle from 275°, by quadrant: |tan| is below 0.61 where the result is not 0.
    let (x, y) = (c * COS_275 + s * SIN_275, s * COS_275 - c * SIN_275);
    let half = y / larger(1.0 + x, 1e-9);
    let quarter = half / (1.0 + (1.0 + half * half).sqrt());
    let square = quarter * quarter;
    let mut series = 0.0;
    for k in (0..16).rev() {
        let term = 1.0 / (2 * k + 1) as f64;
        series = series * square + if k % 2 == 0 { term } else { -term };
    }
    let degrees = 4.0 * quarter * series * (180.0 / std::f64::consts::PI);
    // More than 85° ahead equals 275° and more behind.
    let known = degrees < 85.0 && degrees > -125.0;
    let steps = if known { degrees * 0.04 } else { 8.0 };
    let angle = (std::f64::consts::PI / 3.0) * exp_nonpositive(-steps * steps);
    let square = angle * angle;
    let mut sine = 1.0;
    for k in (1..8).rev() {
        sine = 1.0 - sine * square * (1.0 / (2 * k * (2 * k + 1)) as f64);
    }
    angle * sine
}

/// `exp(x)` for -64 <= x <= 0 within 1e-12: a series at x/64, squared six times.
#[inline(always)]
fn exp_nonpositive(x: f64) -> f64 {
    let small = x * (1.0 / 64.0);
    let mut series = 1.0;
    for k in (1..14).rev() {
        series = 1.0 + series * small * (1.0 / k as f64);
    }
    let mut power = series;
    for _ in 0..6 {
        power *= power;
    }
    power
}

/// ΔE00 of two colors (L, a, b) by the published formulas, angle by angle: the reference of the fast variant.
#[must_use]
pub fn ciede2000_reference([l1, a1, b1]: [f64; 3], [l2, a2, b2]: [f64; 3]) -> f64 {
    let mean_chroma = (a1.hypot(b1) + a2.hypot(b2)) / 2.0;
    let stretch = 1.0 + 0.5 * (1.0 - chroma_ratio(mean_chroma));
    let (a1, a2) = (stretch * a1, stretch * a2);
    let (c1, c2) = (a1.hypot(b1), a2.hypot(b2));
    let [h1, h2] = [(a1, b1), (a2, b2)].map(|(a, b)| match (a, b) {
        (0.0, 0.0) => 0.0,
        _ => b.atan2(a).to_degrees().rem_euclid(360.0),
    });
    let gray = c1 * c2 == 0.0;
    let turn = match h2 - h1 {
        _ if gray => 0.0,
        turn if turn > 180.0 => turn - 360.0,
        turn if turn < -180.0 => turn + 360.0,
        turn => turn,
    };
    let mean_hue = match h1 + h2 {
        sum if gray => sum,
        sum if (h1 - h2).abs() <= 180.0 => sum / 2.0,
        sum if sum < 360.0 => (sum + 360.0) / 2.0,
        sum => (sum - 360.0) / 2.0,
    };
    let t = 1.0 - 0.17 * (mean_hue - 30.0).to_radians().cos()
        + 0.24 * (2.0 * mean_hue).to_radians().cos()
        + 0.32 * (3.0 * mean_hue + 6.0).to_radians().cos()
        - 0.20 * (4.0 * mean_hue - 63.0).to_radians().cos();
    let (lightness, chroma) = ((l1 + l2) / 2.0 - 50.0, (c1 + c2) / 2.0);
    let rotation = 30.0 * (-((mean_hue - 275.0) / 25.0).powi(2)).exp();
    let r_t = -(2.0 * rotation).to_radians().sin() * 2.0 * chroma_ratio(chroma);
    let dl = (l2 - l1) / (1.0 + 0.015 * lightness.powi(2) / (20.0 + lightness.powi(2)).sqrt());
    let dc = (c2 - c1) / (1.0 + 0.045 * chroma);
    let dh = 2.0 * (c1 * c2).sqrt() * (turn / 2.0).to_radians().sin() / (1.0 + 0.015 * chroma * t);
    (dl * dl + dc * dc + dh * dh + r_t * dc * dh).max(0.0).sqrt()
}

/// `sqrt(C⁷ / (C⁷ + 25⁷))` by powers.
fn chroma_ratio(chroma: f64) -> f64 {
    (chroma.powi(7) / (chroma.powi(7) + 25f64.powi(7))).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truncated series, and square roots of small differences.
    const AGREEMENT: f64 = 1e-6;

    /// Pairs from the implementation notes: hues on both sides of 0°, opposite hues, blues, and ordinary ones.
    const PUBLISHED: [([f64; 3], [f64; 3], f64); 16] = [
        ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
        ([50.0, 3.1571, -77.2803], [50.0, 0.0, -82.7485], 2.8615),
        ([50.0, 2.8361, -74.0200], [50.0, 0.0, -82.7485], 3.4412),
        ([50.0, -1.3802, -84.2814], [50.0, 0.0, -82.7485], 1.0000),
        ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
        ([50.0, -1.0, 2.0], [50.0, 0.0, 0.0], 2.3669),
        ([50.0, 2.4900, -0.0010], [50.0, -2.4900, 0.0009], 7.1792),
        ([50.0, 2.4900, -0.0010], [50.0, -2.4900, 0.0011], 7.2195),
        ([50.0, -0.0010, 2.4900], [50.0, 0.0009, -2.4900], 4.8045),
        ([50.0, -0.0010, 2.4900], [50.0, 0.0011, -2.4900], 4.7461),
        ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
        ([50.0, 2.5, 0.0], [58.0, 24.0, 15.0], 19.4535),
        ([60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644),
        ([63.0109, -31.0961, -5.8663], [62.8187, -29.7946, -4.0864], 1.2630),
        ([22.7233, 20.0904, -46.6940], [23.0331, 14.9730, -42.5619], 2.0373),
        ([90.8027, -2.0831, 1.4410], [91.1528, -1.6435, 0.0447], 1.4441),
    ];

    #[test]
    fn published_pairs_come_out_to_four_places() {
        for (one, other, expected) in PUBLISHED {
            for value in [difference(one, other), ciede2000_reference(one, other)] {
                assert!((value - expected).abs() <= 5.1e-5, "{value} for {expected}");
            }
        }
    }

    #[test]
    fn the_fast_form_agrees_with_the_formulas() {
        let color = |i: usize| {
            let code = |shift: usize| (i.wrapping_mul(0x9e37_79b9) >> shift) as u8;
            let light = [3, 11, 19].map(|shift| LINEAR[usize::from(code(shift))]);
            lab::of_linear(light)
        };
        for i in 0..200_000 {
            let (one, other) = (color(i), color(7 * i + 3));
            let (fast, exact) = (difference(one, other), ciede2000_reference(one, other));
            assert!(
                (fast - exact).abs() < AGREEMENT,
                "{one:?} {other:?}: {fast} for {exact}"
            );
        }
    }

    #[test]
    fn the_mean_of_a_picture_is_over_its_pixels_alone() {
        let (black, white) = (
            Rgb8::from_fn(5, 1, |_, _| [0; 3]),
            Rgb8::from_fn(5, 1, |_, _| [255; 3]),
        );
        assert!((mean(&black, &white) - 100.0).abs() < 1e-3);
        assert_eq!(mean(&white, &white), 0.0);
        let half = Rgb8::from_fn(5, 1, |x, _| if x < 2 { [255; 3] } else { [0; 3] });
        assert!((mean(&half, &black) - 40.0).abs() < 1e-3);
    }
}
