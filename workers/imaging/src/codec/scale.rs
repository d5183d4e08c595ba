//! Downscales pictures for display.

use crate::Rgb8;

/// A picture whose longer side is at most `max_side`, by the mean of the codes under each new pixel. Averages codes,
/// not light: for previews and sheets only. A picture within the limit is returned unchanged.
#[must_use]
pub fn downscale(picture: &Rgb8, max_side: usize) -> Rgb8 {
    let (width, height) = (picture.width(), picture.height());
    let longer = width.max(height);
    if longer <= max_side || max_side == 0 {
        return picture.clone();
    }
    let [columns, rows] = [width, height].map(|side| (side * max_side / longer).max(1));
    Rgb8::from_fn(columns, rows, |x, y| {
        let mut sums = [0u64; 3];
        let mut pixels = 0u64;
        for row in y * height / rows..((y + 1) * height).div_ceil(rows) {
            for column in x * width / columns..((x + 1) * width).div_ceil(columns) {
                for (sum, code) in sums.iter_mut().zip(picture.pixel(column, row)) {
                    *sum += u64::from(code);
                }
                pixels += 1;
            }
        }
        sums.map(|sum| ((sum + pixels / 2) / pixels) as u8)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longer_side_shrinks_to_the_limit_and_means_are_kept() {
        let picture = Rgb8::from_fn(8, 4, |x, _| if x < 4 { [0; 3] } else { [200; 3] });
        let small = downscale(&picture, 4);
        assert_eq!((small.width(), small.height()), (4, 2));
        assert_eq!((small.pixel(0, 0), small.pixel(3, 1)), ([0; 3], [200; 3]));
        assert_eq!(downscale(&picture, 1).pixel(0, 0), [100; 3]);
        assert_eq!(downscale(&picture, 8), picture);
    }
}
