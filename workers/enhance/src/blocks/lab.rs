//! CIE Lab of sRGB-encoded values in single precision, for loops that cannot use the tables of `imaging`.
//!
//! L, a and b are within 1e-4 of `imaging::lab` for values in 0..=1.

use imaging::transfer;

use crate::elementary::{cube_root, fifth_root};

/// Rows of linear sRGB → XYZ relative to the white.
const TO_XYZ: [[f32; 3]; 3] = [
    [0.433_949_94, 0.376_209_77, 0.189_840_29],
    [0.212_672_9, 0.715_152_2, 0.072_175],
    [0.017_756_583, 0.109_467_96, 0.872_775_46],
];
const KNEE: f32 = 6.0 / 29.0;

/// L, a, b of encoded values in 0..=1.
#[inline(always)]
pub(crate) fn lab_of_encoded(encoded: [f32; 3]) -> [f32; 3] {
    // Without `map`, which is not inlined for long functions.
    let [r, g, b] = [decode(encoded[0]), decode(encoded[1]), decode(encoded[2])];
    let [to_x, to_y, to_z] = TO_XYZ;
    let x = response(to_x[0] * r + to_x[1] * g + to_x[2] * b);
    let y = response(to_y[0] * r + to_y[1] * g + to_y[2] * b);
    let z = response(to_z[0] * r + to_z[1] * g + to_z[2] * b);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// `imaging::transfer::decode` in single precision, for at least 0.
#[inline(always)]
fn decode(v: f32) -> f32 {
    let base = (v + 0.055) * (1.0 / 1.055);
    // The power 2.4 of the base is the square of base times its fifth root.
    let root = base * fifth_root(base);
    if v > 0.040_45 {
        root * root
    } else {
        v * (1.0 / 12.92)
    }
}

/// `f(t)` of CIE Lab: the cube root, and a straight line near 0.
#[inline(always)]
fn response(t: f32) -> f32 {
    const THRESHOLD: f32 = KNEE * KNEE * KNEE;
    const SLOPE: f32 = 1.0 / (3.0 * KNEE * KNEE);
    let root = cube_root(if t > THRESHOLD { t } else { THRESHOLD });
    if t > THRESHOLD {
        root
    } else {
        t * SLOPE + 4.0 / 29.0
    }
}

/// Linear light of L, a, b by the rows of `imaging::lab::from_xyz`; outside of 0..=1 for colors outside of sRGB.
#[inline(always)]
pub(crate) fn linear_of_lab([l, a, b]: [f32; 3], from_xyz: &[[f32; 3]; 3]) -> [f32; 3] {
    let y = (l + 16.0) / 116.0;
    let xyz = [
        invert_response(y + a / 500.0),
        invert_response(y),
        invert_response(y - b / 200.0),
    ];
    from_xyz.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2])
}

/// The inverse of [`response`].
#[inline(always)]
pub(crate) fn invert_response(t: f32) -> f32 {
    let cube = t * t * t;
    if t > KNEE {
        cube
    } else {
        3.0 * KNEE * KNEE * (t - 4.0 / 29.0)
    }
}

/// L, a, b of encoded values in 0..=1, by the exact functions.
pub(crate) fn exact_lab(encoded: [f64; 3]) -> [f64; 3] {
    imaging::lab::of_linear(encoded.map(transfer::decode))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_precision_is_close_and_returns_to_linear_light() {
        let from_xyz = imaging::lab::from_xyz().map(|row| row.map(|value| value as f32));
        let steps = || (0..=24u8).map(|step| f64::from(step) / 24.0);
        for r in steps() {
            for g in steps() {
                for b in steps() {
                    let exact = exact_lab([r, g, b]);
                    let single = lab_of_encoded([r, g, b].map(|value| value as f32));
                    for (single, exact) in single.iter().zip(exact) {
                        assert!(
                            (f64::from(*single) - exact).abs() < 1e-4,
                            "{r} {g} {b}: {single} for {exact}"
                        );
                    }
                    for (light, encoded) in linear_of_lab(single, &from_xyz).iter().zip([r, g, b]) {
                        assert!(
                            (f64::from(*light) - transfer::decode(encoded)).abs() < 3e-6,
                            "{light}"
                        );
                    }
                }
            }
        }
    }
}
