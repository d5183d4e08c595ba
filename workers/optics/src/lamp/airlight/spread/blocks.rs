//! Chooses the rays that each block of pixels is interpolated between.

use std::ops::Range;

use imaging::simd::{larger, smaller};
use imaging::vectorized;

use super::super::Errors;
use super::bends::{ACROSS, Place};
use super::ends::BY_ITSELF;
use super::line::Line;
use super::murkiness::Murkiness;
use super::read::{Band, Block, lanes};
use super::{FINEST, FINEST_IN_DEGREES, Frame, RUN, SHARE_OF_CONE, STEP};

impl Frame<'_> {
    /// Fills the blocks of a row selected by `asked`, `step` pixels a side, among the lines of rays of its pair of rows. Returns
    /// the error bound.
    pub(super) fn fill(
        &self,
        band: &mut Band<'_>,
        lines: &[Line],
        (step, row): (usize, usize),
        asked: &[bool],
    ) -> Errors {
        let mut finer = vec![false; asked.len()];
        let (mut worst, mut blocks) = (Errors::default(), Vec::new());
        for column in (0..asked.len()).filter(|&column| asked[column]) {
            let Some(cells) = self.cells_of(band, (step, row), column) else {
                continue;
            };
            let place = Place::new(lines, (column, row));
            match self.left(place, step, cells) {
                Some(left) => {
                    let (xs, _) = self.pixels(step, (column, row));
                    let bends = if self.is_bent() {
                        place.bends(cells)
                    } else {
                        Vec::new()
                    };
                    blocks.push(Block::new(place, (cells.0, bends), xs));
                    worst.left = worst.left.max(left);
                }
                None => finer[column] = true,
            }
        }
        let (_, ys) = self.pixels(step, (0, row));
        self.read(band, &mut blocks, (step, ys));
        let finest = if let Murkiness::Degrees(_) = self.murkiness {
            FINEST_IN_DEGREES
        } else {
            FINEST
        };
        if finer.contains(&true) {
            worst.include(if step > finest {
                self.fill_finer(band, (step / 2, row), &finer)
            } else {
                self.sum_up_blocks(band, (step, row), &finer)
            });
        }
        worst
    }

    /// Whether interpolation between rays is parabolic instead of linear: degrees make parabolas too expensive.
    fn is_bent(&self) -> bool {
        !matches!(self.murkiness, Murkiness::Degrees(_))
    }

    /// Error estimate of a block whose rays end in some cells, beyond the tolerated share of its light; `None` if it is above the
    /// limit.
    fn left(&self, place: Place<'_>, step: usize, cells: (usize, usize)) -> Option<f64> {
        let [top, bottom] = place.beside();
        let nearest_m = place
            .rays()
            .map(|ray| top.distance_m(ray).min(bottom.distance_m(ray)))
            .into_iter()
            .fold(f32::INFINITY, f32::min);
        if self.turn(step, nearest_m) > SHARE_OF_CONE {
            return None;
        }
        let left =
            place.left(cells, self.is_bent(), self.tolerated_share) * f64::from(self.murkiness.most_source());
        (left <= self.tolerance).then_some(left)
    }

    /// First and last end cell of the rays of a block; `None` if all are integrated separately.
    fn cells_of(&self, band: &Band<'_>, place: (usize, usize), column: usize) -> Option<(usize, usize)> {
        let (xs, ys) = self.pixels(place.0, (column, place.1));
        let width = self.range.width();
        let rows = &band.ends.places[ys.start * width..ys.end * width];
        let mut ends = (f32::INFINITY, -1.0f32);
        vectorized!(ends_of(rows, width, &xs, &mut ends));
        let cells = self.cut.cells;
        let cell = |place: f32| ((place * cells as f32) as usize).min(cells - 1);
        (ends.1 >= 0.0).then(|| (cell(ends.0), cell(ends.1)))
    }

    /// Fills blocks of `2 · step` pixels a side by rays that are `step` pixels apart.
    fn fill_finer(&self, band: &mut Band<'_>, (step, row): (usize, usize), blocks: &[bool]) -> Errors {
        let (width, height) = self.range.size();
        let asked: Vec<bool> = (0..width.div_ceil(step))
            .map(|column| blocks[column / 2])
            .collect();
        // Of each block those across the pair that it is cut into.
        let needed: Vec<bool> = (0..2 * blocks.len() + ACROSS - 2)
            .map(|ray| {
                let first = (ray + 1).saturating_sub(ACROSS).div_ceil(2);
                blocks[first..blocks.len().min(ray / 2 + 1)].contains(&true)
            })
            .collect();
        let first = 2 * row as i64 - 1;
        let lines = Line::of_rows(self, (step, first..first + ACROSS as i64), self.cut, &needed);
        let mut worst = Errors::default();
        for half in 0..2 {
            if (2 * row + half) * step < height {
                worst.include(self.fill(band, &lines, (step, 2 * row + half), &asked));
            }
        }
        worst
    }

    /// Sums up along the ray of each pixel of some blocks.
    fn sum_up_blocks(&self, band: &mut Band<'_>, (step, row): (usize, usize), blocks: &[bool]) -> Errors {
        let width = self.range.width();
        let mut pixels = Vec::new();
        for column in (0..blocks.len()).filter(|&column| blocks[column]) {
            let (xs, ys) = self.pixels(step, (column, row));
            pixels.extend(ys.flat_map(|y| xs.clone().map(move |x| y * width + x)));
        }
        pixels.retain(|&pixel| band.ends.places[pixel] >= 0.0);
        self.sum_up_each(band, &pixels)
    }

    /// Sums up along the ray of each of some pixels.
    pub(super) fn sum_up_each(&self, band: &mut Band<'_>, pixels: &[usize]) -> Errors {
        let mut worst = Errors::default();
        for pixels in pixels.chunks(RUN) {
            let (light, errors) = self.sum_up(pixels);
            worst.include(errors);
            for (i, &pixel) in pixels.iter().enumerate() {
                band.add(
                    pixel,
                    self.range.width(),
                    [0, 1, 2].map(|channel| light[channel][i]),
                );
            }
        }
        worst
    }

    /// The columns and rows of a block, clipped to the frame.
    pub(super) fn pixels(&self, step: usize, (column, row): (usize, usize)) -> (Range<usize>, Range<usize>) {
        let (width, height) = self.range.size();
        (
            column * step..width.min((column + 1) * step),
            row * step..height.min((row + 1) * step),
        )
    }
}

/// The least nonnegative and the greatest place of some columns.
#[inline(always)]
fn ends_of(rows: &[f32], width: usize, xs: &Range<usize>, ends: &mut (f32, f32)) {
    let (mut first, mut last) = ([f32::INFINITY; STEP], [BY_ITSELF; STEP]);
    for row in rows.chunks_exact(width) {
        let own = lanes(&row[xs.clone()], BY_ITSELF);
        for x in 0..STEP {
            let read = if own[x] >= 0.0 { own[x] } else { f32::INFINITY };
            first[x] = smaller(read, first[x]);
            last[x] = larger(own[x], last[x]);
        }
    }
    for x in 0..STEP {
        ends.0 = smaller(first[x], ends.0);
        ends.1 = larger(last[x], ends.1);
    }
}
