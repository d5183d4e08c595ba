//! Which blocks of pixels are read between which rays.

use std::ops::Range;

use super::line::Line;
use super::read::Band;
use super::{FINEST, FINEST_IN_PATCHES, Frame, RUN, SHARE_OF_CONE};

impl Frame<'_> {
    /// Fills those blocks of a row that are `asked` for: `step` pixels a side, between the two inner of four lines of rays. Returns
    /// what may be left.
    pub(super) fn fill(
        &self,
        band: &mut Band,
        lines: &[Line],
        (step, row): (usize, usize),
        asked: &[bool],
    ) -> f64 {
        let [above, top, bottom, below] = lines else {
            unreachable!("a row of blocks has four lines")
        };
        let tolerance = self.lamp.source.tolerance;
        let source = f64::from(self.murkiness.most_source());
        let is_corner = |ray: usize| {
            let block = |column: usize| asked.get(column).copied().unwrap_or(false);
            (ray >= 1 && block(ray - 1)) || (ray >= 2 && block(ray - 2))
        };
        let left: Vec<f64> = (0..asked.len() + 3)
            .map(|ray| {
                if !is_corner(ray) {
                    return 0.0;
                }
                source * f64::max(top.left(ray, above, bottom), bottom.left(ray, top, below))
            })
            .collect();
        let mut finer = vec![false; asked.len()];
        let mut worst = 0.0f64;
        for column in (0..asked.len()).filter(|&column| asked[column]) {
            // The first ray lies before the frame.
            let corners = [column + 1, column + 2];
            let block_left = corners.map(|ray| left[ray]).into_iter().fold(0.0, f64::max);
            let nearest_m = corners
                .map(|ray| top.distance_m(ray).min(bottom.distance_m(ray)))
                .into_iter()
                .fold(f32::INFINITY, f32::min);
            if block_left <= tolerance && self.turn(step, nearest_m) <= SHARE_OF_CONE {
                self.read(band, [top, bottom], (step, row), column);
                worst = worst.max(block_left);
            } else {
                finer[column] = true;
            }
        }
        let finest = if self.patches.is_some() {
            FINEST_IN_PATCHES
        } else {
            FINEST
        };
        if !finer.contains(&true) {
            worst
        } else if step > finest {
            worst.max(self.fill_finer(band, (step / 2, row), &finer))
        } else {
            worst.max(self.sum_up_blocks(band, (step, row), &finer))
        }
    }

    /// Fills blocks of `2 · step` pixels a side by rays that lie `step` apart.
    fn fill_finer(&self, band: &mut Band, (step, row): (usize, usize), blocks: &[bool]) -> f64 {
        let (width, height) = self.range.size();
        let asked: Vec<bool> = (0..width.div_ceil(step))
            .map(|column| blocks[column / 2])
            .collect();
        // Of each block the corners and what is beside them.
        let needed: Vec<bool> = (0..asked.len() + 3)
            .map(|ray| asked[ray.saturating_sub(3)..asked.len().min(ray + 1)].contains(&true))
            .collect();
        let rows = (-1..=3).map(|i| 2 * row as i64 + i);
        let lines: Vec<Line> = rows
            .map(|row| Line::new(self, (step, row), band.cells(), &needed))
            .collect();
        let mut worst = 0.0f64;
        for half in 0..2 {
            if (2 * row + half) * step < height {
                let left = self.fill(band, &lines[half..half + 4], (step, 2 * row + half), &asked);
                worst = worst.max(left);
            }
        }
        worst
    }

    /// Sums up along the ray of each pixel of some blocks.
    fn sum_up_blocks(&self, band: &mut Band, (step, row): (usize, usize), blocks: &[bool]) -> f64 {
        let width = self.range.width();
        let mut pixels = Vec::new();
        for column in (0..blocks.len()).filter(|&column| blocks[column]) {
            let (xs, ys) = self.pixels(step, (column, row));
            pixels.extend(ys.flat_map(|y| xs.clone().map(move |x| y * width + x)));
        }
        let mut left = 0.0f64;
        for pixels in pixels.chunks(RUN) {
            let (sum, _) = self.sum_up(pixels);
            left = left.max(sum.left);
            for (i, &at) in pixels.iter().enumerate() {
                band.set(at, [0, 1, 2].map(|channel| sum.light[channel][i]));
            }
        }
        left
    }

    /// The columns and rows of a block, as far as they lie in the frame.
    pub(super) fn pixels(&self, step: usize, (column, row): (usize, usize)) -> (Range<usize>, Range<usize>) {
        let (width, height) = self.range.size();
        (
            column * step..width.min((column + 1) * step),
            row * step..height.min((row + 1) * step),
        )
    }
}
