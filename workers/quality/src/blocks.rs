//! Square blocks from the top left corner; the remainder at the right and at the bottom is ignored.

use imaging::Plane;
use imaging::simd::{larger, smaller};

use crate::mask::contains_block;

/// The block grid over a picture.
pub(crate) struct BlockGrid {
    width_px: usize,
    height_px: usize,
    across: usize,
    down: usize,
}

impl BlockGrid {
    /// BlockGrid of `side` pixels; a shorter axis has one block of its length.
    pub(crate) fn new((width, height): (usize, usize), side: usize) -> Self {
        let (width_px, height_px) = (side.min(width), side.min(height));
        Self {
            width_px,
            height_px,
            across: width / width_px,
            down: height / height_px,
        }
    }

    /// Of the values of all blocks those of blocks entirely inside the mask.
    pub(crate) fn keep_inside<T>(&self, mut values: Vec<T>, mask: Option<&Plane<u8>>) -> Vec<T> {
        if let Some(mask) = mask {
            let mut block = 0;
            values.retain(|_| {
                let (x, y) = (
                    block % self.across * self.width_px,
                    block / self.across * self.height_px,
                );
                block += 1;
                contains_block(mask, x..x + self.width_px, y..y + self.height_px)
            });
        }
        values
    }

    /// Number of rows inside blocks.
    pub(crate) fn rows(&self) -> usize {
        self.down * self.height_px
    }

    /// Minimum and maximum sample of each block, row-major. A picture's row has `samples` values per pixel, and
    /// `fill(y, row)` writes the part of row y inside blocks. Each row is requested once, from the top down.
    #[inline(always)]
    pub(crate) fn extremes<T: Copy + PartialOrd + Default>(
        &self,
        samples: usize,
        mut fill: impl FnMut(usize, &mut [T]),
    ) -> Vec<(T, T)> {
        let block = self.width_px * samples;
        let mut row = vec![T::default(); self.across * block];
        let mut low = row.clone();
        let mut high = row.clone();
        let mut extremes = Vec::with_capacity(self.across * self.down);
        for y in 0..self.rows() {
            if y % self.height_px == 0 {
                fill(y, &mut low);
                high.copy_from_slice(&low);
            } else {
                fill(y, &mut row);
                for ((low, high), &value) in low.iter_mut().zip(&mut high).zip(&row) {
                    *low = smaller(value, *low);
                    *high = larger(value, *high);
                }
            }
            if y % self.height_px == self.height_px - 1 {
                extremes.extend(
                    low.chunks_exact(block)
                        .zip(high.chunks_exact(block))
                        .map(|(low, high)| {
                            let least = low.iter().copied().fold(low[0], smaller);
                            let greatest = high.iter().copied().fold(high[0], larger);
                            (least, greatest)
                        }),
                );
            }
        }
        extremes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn left_over_columns_and_rows_belong_to_no_block() {
        let blocks = BlockGrid::new((5, 3), 2);
        let extremes = blocks.extremes(1, |y, row: &mut [u8]| {
            for (x, sample) in row.iter_mut().enumerate() {
                *sample = (10 * y + x) as u8;
            }
        });
        assert_eq!(extremes, [(0, 11), (2, 13)]);
    }

    #[test]
    fn a_short_axis_is_one_block_long() {
        let blocks = BlockGrid::new((25, 3), 10);
        assert_eq!((blocks.across, blocks.down, blocks.rows()), (2, 1, 3));
    }

    #[test]
    fn blocks_that_touch_the_outside_of_a_mask_are_dropped() {
        let blocks = BlockGrid::new((7, 5), 2);
        let mask = Plane::from_fn(7, 5, |x, y| if (x, y) == (3, 2) || x > 5 { 0 } else { 9 });
        let kept = blocks.keep_inside((0..6).collect(), Some(&mask));
        assert_eq!(kept, [0, 1, 2, 3, 5]);
        assert_eq!(blocks.keep_inside(vec![4; 6], None), [4; 6]);
    }
}
