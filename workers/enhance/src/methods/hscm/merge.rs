//! Merges a new luma with the chroma of the input: replaces Y of YUV and keeps U and V.

use imaging::{luma1000, vectorized};

/// `C' = clip(round(C + Y' - Y))` for every channel C, with `Y = (299 R + 587 G + 114 B) / 1000`, halves rounded up, in
/// exact integers. `colors` is interleaved R, G, B; `luma` has one code per pixel.
#[must_use]
pub fn merge(colors: &[u8], luma: &[u8]) -> Vec<u8> {
    debug_assert_eq!(colors.len(), 3 * luma.len());
    let mut merged = vec![0; colors.len()];
    vectorized!(replace(colors, luma, &mut merged));
    merged
}

#[inline(always)]
fn replace(colors: &[u8], luma: &[u8], merged: &mut [u8]) {
    let pixels = colors.chunks_exact(3).zip(merged.chunks_exact_mut(3));
    for ((from, to), &luma) in pixels.zip(luma) {
        // C + Y' is an integer, so rounding halves of the sum up equals rounding halves of Y down.
        let old = ((luma1000([from[0], from[1], from[2]]) + 499) / 1000) as i16;
        let shift = i16::from(luma) - old;
        for (to, &code) in to.iter_mut().zip(from) {
            *to = (i16::from(code) + shift).clamp(0, 255) as u8;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_half_is_rounded_up() {
        // Luma of (0, 0, 250) is 28.5: 0 + 30 - 28.5 = 1.5 and 250 + 30 - 28.5 saturates.
        assert_eq!(merge(&[0, 0, 250], &[30]), [2, 2, 252]);
        // Luma of (10, 10, 10) is 10: gray becomes the new luma.
        assert_eq!(merge(&[10, 10, 10], &[77]), [77, 77, 77]);
    }

    #[test]
    fn every_pixel_follows_the_floor_division_of_the_definition() {
        for r in (0..256i32).step_by(5) {
            for g in (0..256i32).step_by(3) {
                for (b, y) in [(0, 0), (7, 255), (128, 64), (250, 128), (255, 31)] {
                    let luma = 299 * r + 587 * g + 114 * b;
                    let expected =
                        [r, g, b].map(|c| (1000 * (c + y) - luma + 500).div_euclid(1000).clamp(0, 255) as u8);
                    assert_eq!(merge(&[r as u8, g as u8, b as u8], &[y as u8]), expected);
                }
            }
        }
    }
}
