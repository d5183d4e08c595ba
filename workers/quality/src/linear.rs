//! Linear light of sRGB codes.

use std::sync::LazyLock;

use imaging::transfer;

/// Linear light of each sRGB code.
pub(crate) static LINEAR: LazyLock<[f64; 256]> =
    LazyLock::new(|| std::array::from_fn(|code| transfer::decode(code as f64 / 255.0)));

/// Weights of linear red, green and blue in luminance (IEC 61966-2-1).
pub(crate) const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];
/// Half of the light of code 1: below the resolution of codes.
pub(crate) const HALF_CODE: f64 = 0.5 / 255.0 / 12.92;

/// Linear luminance of a pixel, 0..=1.
pub(crate) fn luminance([r, g, b]: [u8; 3]) -> f64 {
    let linear: &[f64; 256] = &LINEAR;
    LUMINANCE[0] * linear[usize::from(r)]
        + LUMINANCE[1] * linear[usize::from(g)]
        + LUMINANCE[2] * linear[usize::from(b)]
}
