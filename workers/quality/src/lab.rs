//! CIE Lab of sRGB codes, white (0.95047, 1, 1.08883), in parts that a loop can vectorise.

use std::sync::LazyLock;

/// Linear light of each sRGB code.
pub(crate) static LINEAR: LazyLock<[f64; 256]> = LazyLock::new(|| {
    std::array::from_fn(|code| {
        let c = code as f64 / 255.0;
        if c <= 0.04045 {
            c / 12.92
        } else {
            ((c + 0.055) / 1.055).powf(2.4)
        }
    })
});

/// Rows of linear sRGB → XYZ, each divided by the white.
pub(crate) const TO_XYZ: [[f64; 3]; 3] = [
    [
        0.412_456_4 / 0.950_47,
        0.357_576_1 / 0.950_47,
        0.180_437_5 / 0.950_47,
    ],
    [0.212_672_9, 0.715_152_2, 0.072_175],
    [
        0.019_333_9 / 1.088_83,
        0.119_192 / 1.088_83,
        0.950_304_1 / 1.088_83,
    ],
];

/// `f(t)` of CIE Lab: the cube root, and a straight line near 0.
#[inline(always)]
pub(crate) fn lab_response(t: f64) -> f64 {
    const KNEE: f64 = (6.0 / 29.0) * (6.0 / 29.0) * (6.0 / 29.0);
    const SLOPE: f64 = 1.0 / (3.0 * (6.0 / 29.0) * (6.0 / 29.0));
    let root = cube_root(t.max(KNEE));
    if t > KNEE { root } else { t * SLOPE + 4.0 / 29.0 }
}

/// Cube root of a normal positive number within 1e-14 of itself: a third of the exponent as first guess (3 % off),
/// then a Halley step in single and one in double precision, each of which cubes the error.
#[inline(always)]
fn cube_root(t: f64) -> f64 {
    let single = t as f32;
    let guess = f32::from_bits(single.to_bits() / 3 + 0x2a51_37a0);
    let cube = guess * guess * guess;
    let root = f64::from(guess * ((cube + 2.0 * single) / (2.0 * cube + single)));
    let cube = root * root * root;
    root * ((cube + 2.0 * t) / (2.0 * cube + t))
}

/// L, a, b of linear light.
#[inline(always)]
pub(crate) fn of_linear(r: f64, g: f64, b: f64) -> [f64; 3] {
    let [x, y, z] = TO_XYZ.map(|row| lab_response(row[0] * r + row[1] * g + row[2] * b));
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cube_root_is_exact_to_rounding() {
        for i in 1..=200_000u32 {
            let t = f64::from(i) / 190_000.0;
            assert!((cube_root(t) / t.cbrt() - 1.0).abs() < 1e-14, "{t}");
        }
    }

    #[test]
    fn red_and_gray_have_their_known_places() {
        let near = |got: [f64; 3], expected: [f64; 3]| {
            for (got, expected) in got.iter().zip(expected) {
                assert!((got - expected).abs() < 5e-3, "{got} for {expected}");
            }
        };
        near(of_linear(LINEAR[255], 0.0, 0.0), [53.241, 80.092, 67.203]);
        near(of_linear(0.18, 0.18, 0.18), [49.496, 0.0, 0.0]);
    }
}
