//! CIE Lab of linear light and back (CIE 15:2004, sections 8.2.1 and 8.2.1.4), white (0.95047, 1, 1.08883), in
//! vectorizable parts.
//!
//! Linear light → XYZ with the sRGB primaries (IEC 61966-2-1) → `f(t) = cbrt t` above (6/29)³ and `t / (3 (6/29)²) +
//! 4/29` below → `L = 116 f(Y) - 16`, `a = 500 (f(X) - f(Y))`, `b = 200 (f(Y) - f(Z))` with X, Y, Z relative to the
//! white. L is 0..=100 for light of 0..=1; a and b have no unit.

use std::sync::LazyLock;

/// Rows of linear sRGB → XYZ relative to the white.
const TO_XYZ: [[f64; 3]; 3] = [
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
/// The inverse of [`TO_XYZ`].
static FROM_XYZ: LazyLock<[[f64; 3]; 3]> = LazyLock::new(|| {
    let m = TO_XYZ;
    let cofactor = |i: usize, j: usize| {
        let (a, b, c, d) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let determinant: f64 = (0..3).map(|j| m[0][j] * cofactor(0, j)).sum();
    std::array::from_fn(|i| std::array::from_fn(|j| cofactor(j, i) / determinant))
});

const KNEE: f64 = 6.0 / 29.0;

/// Rows of XYZ relative to the white → linear sRGB, for [`to_linear`].
#[must_use]
pub fn from_xyz() -> &'static [[f64; 3]; 3] {
    &FROM_XYZ
}

/// `f(t)` of CIE Lab: the cube root, and a straight line near 0.
#[inline(always)]
fn response(t: f64) -> f64 {
    const THRESHOLD: f64 = KNEE * KNEE * KNEE;
    const SLOPE: f64 = 1.0 / (3.0 * KNEE * KNEE);
    let root = cube_root(t.max(THRESHOLD));
    if t > THRESHOLD {
        root
    } else {
        t * SLOPE + 4.0 / 29.0
    }
}

/// Cube root of a normal positive number with a relative error of 1e-14: a third of the exponent as first guess (3 %
/// off), then a Halley step in f32 and one in f64, each of which cubes the error.
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
#[must_use]
pub fn of_linear(light: [f64; 3]) -> [f64; 3] {
    let [r, g, b] = light;
    let [x, y, z] = TO_XYZ.map(|row| response(row[0] * r + row[1] * g + row[2] * b));
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// L, a, b of at most `N` pixels of interleaved codes, black beyond them; `linear` is the light of the codes of red,
/// green and blue.
#[inline(always)]
#[must_use]
pub fn of_codes<const N: usize>(codes: &[u8], linear: [&[f64; 256]; 3]) -> [[f64; N]; 3] {
    let mut light = [[0.0f64; N]; 3];
    for (channel, light) in light.iter_mut().enumerate() {
        for (light, pixel) in light.iter_mut().zip(codes.chunks_exact(3)) {
            *light = linear[channel][usize::from(pixel[channel])];
        }
    }
    let mut lab = [[0.0f64; N]; 3];
    for x in 0..N {
        let [l, a, b] = of_linear([light[0][x], light[1][x], light[2][x]]);
        lab[0][x] = l;
        lab[1][x] = a;
        lab[2][x] = b;
    }
    lab
}

/// Linear light of L, a, b; outside of 0..=1 for colors outside of sRGB.
#[inline(always)]
#[must_use]
pub fn to_linear([l, a, b]: [f64; 3], from_xyz: &[[f64; 3]; 3]) -> [f64; 3] {
    let y = (l + 16.0) / 116.0;
    let xyz = [
        invert_response(y + a / 500.0),
        invert_response(y),
        invert_response(y - b / 200.0),
    ];
    from_xyz.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2])
}

/// Inverse of [`response`].
#[inline(always)]
fn invert_response(t: f64) -> f64 {
    if t > KNEE {
        t * t * t
    } else {
        3.0 * KNEE * KNEE * (t - 4.0 / 29.0)
    }
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
    fn white_gray_and_red_have_their_known_places() {
        let near = |got: [f64; 3], expected: [f64; 3]| {
            for (got, expected) in got.iter().zip(expected) {
                assert!((got - expected).abs() < 5e-3, "{got} for {expected}");
            }
        };
        near(of_linear([1.0; 3]), [100.0, 0.0, 0.0]);
        near(of_linear([0.0; 3]), [0.0, 0.0, 0.0]);
        near(of_linear([0.18; 3]), [49.496, 0.0, 0.0]);
        near(of_linear([1.0, 0.0, 0.0]), [53.241, 80.092, 67.203]);
    }

    #[test]
    fn colors_come_back() {
        for r in [0.0, 0.001, 0.2, 1.0] {
            for g in [0.0, 0.01, 0.5, 1.0] {
                for b in [0.0, 0.003, 0.7, 1.0] {
                    let back = to_linear(of_linear([r, g, b]), from_xyz());
                    for (back, value) in back.iter().zip([r, g, b]) {
                        assert!((back - value).abs() < 1e-12, "{back} for {value}");
                    }
                }
            }
        }
    }
}
