//! The fast variant: the circular Gaussian as two short passes in f32.
//!
//! One sweep down the picture. A ring holds the rows of a column sum, so that all data stay in the cache between the
//! logarithm and the finished row. Padding is never stored: each pass maps padded positions to samples.

use imaging::reflected;

use super::logarithm::Logarithm;
use super::padding::padded_side;
use super::parameters::Filter;
use super::recipe::PassKernels;
use crate::methods::hscm::luma::Luma;

/// Columns whose sums stay in registers: four vectors of eight.
pub(super) const BLOCK: usize = 32;

/// Filters a picture; calls `finish` with each finished row of `x`, from the top down. Compile it by `vectorized!`.
#[inline(always)]
pub(super) fn sweep(
    luma: &Luma,
    filter: &Filter,
    kernels: &PassKernels,
    finish: &mut impl FnMut(usize, &[f32]),
) {
    let (gain, drop) = (filter.gain_high as f32, filter.drop() as f32);
    let (width, height) = luma.codes().size();
    let padded = padded_side(height);
    let radius = kernels.y.len() - 1;
    let mut rows = RowPass::new(luma, filter.eps, &kernels.x);
    let mut logs = RowRing::new(2 * radius + 1, rows.stride);
    let mut blurred = RowRing::new(2 * radius + 1, rows.stride);
    let mut filtered = vec![0.0f32; rows.stride];
    // Positions count from `radius` rows above the picture, on a circle of `padded` rows.
    for position in 0..height + 2 * radius {
        let y = reflected(((position + padded - radius) % padded) as isize, height);
        rows.run(y, logs.row_mut(position), blurred.row_mut(position));
        let Some(y) = position.checked_sub(2 * radius) else {
            continue;
        };
        let center = y + radius;
        let rows_around = blurred.rows_around(center, radius);
        let blocks = filtered
            .chunks_exact_mut(BLOCK)
            .zip(logs.row(center).chunks_exact(BLOCK));
        for (block, (x, log)) in blocks.enumerate() {
            let sums = weighted_sum(&kernels.y, |offset| {
                &rows_around[radius.wrapping_add_signed(offset)][block * BLOCK..]
            });
            for i in 0..BLOCK {
                x[i] = gain * log[i] - drop * sums[i];
            }
        }
        finish(y, &filtered[..width]);
    }
}

/// The latest rows of a sweep by position.
pub(super) struct RowRing {
    rows: usize,
    stride: usize,
    samples: Vec<f32>,
}

impl RowRing {
    pub(super) fn new(rows: usize, stride: usize) -> Self {
        Self {
            rows,
            stride,
            samples: vec![0.0; rows * stride],
        }
    }

    #[inline(always)]
    pub(super) fn row(&self, position: usize) -> &[f32] {
        &self.samples[position % self.rows * self.stride..][..self.stride]
    }

    /// The rows up to `radius` before and after a position. Looked up once for all blocks of a row: a division for every tap of every
    /// block takes as long as the sums.
    #[inline(always)]
    pub(super) fn rows_around(&self, center: usize, radius: usize) -> Vec<&[f32]> {
        (center - radius..=center + radius)
            .map(|position| self.row(position))
            .collect()
    }

    #[inline(always)]
    pub(super) fn row_mut(&mut self, position: usize) -> &mut [f32] {
        &mut self.samples[position % self.rows * self.stride..][..self.stride]
    }
}

/// Computes the logarithm and row sums of one row.
struct RowPass<'a> {
    luma: &'a Luma,
    kernel: &'a [f32],
    logarithm: Logarithm,
    /// Columns of the picture that precede and follow it on the padded circle.
    before: Vec<usize>,
    after: Vec<usize>,
    /// A row with its neighbors on both sides, rounded up to whole blocks.
    line: Vec<f32>,
    /// Width rounded up to whole blocks.
    stride: usize,
}

impl<'a> RowPass<'a> {
    fn new(luma: &'a Luma, eps: f64, kernel: &'a [f32]) -> Self {
        let width = luma.codes().width();
        let padded = padded_side(width);
        let radius = kernel.len() - 1;
        let stride = width.next_multiple_of(BLOCK);
        let [before, after] = [padded - radius, width].map(|first| {
            let positions = (first..first + radius).map(|i| i % padded);
            positions.map(|i| reflected(i as isize, width)).collect()
        });
        Self {
            luma,
            kernel,
            logarithm: Logarithm::new(luma, eps),
            before,
            after,
            line: vec![0.0; stride + 2 * radius],
            stride,
        }
    }

    #[inline(always)]
    fn run(&mut self, y: usize, logs: &mut [f32], blurred: &mut [f32]) {
        let logs = &mut logs[..self.luma.codes().width()];
        self.logarithm.row(self.luma.codes().row(y), logs);
        let (before, line) = self.line.split_at_mut(self.before.len());
        let (inside, after) = line.split_at_mut(logs.len());
        inside.copy_from_slice(logs);
        let beyond = before.iter_mut().zip(&self.before);
        for (sample, column) in beyond.chain(after.iter_mut().zip(&self.after)) {
            *sample = logs[*column];
        }
        let radius = self.before.len();
        for (block, out) in blurred.chunks_exact_mut(BLOCK).enumerate() {
            let window = &self.line[block * BLOCK..][..BLOCK + 2 * radius];
            out.copy_from_slice(&weighted_sum(self.kernel, |offset| {
                &window[radius.wrapping_add_signed(offset)..]
            }));
        }
    }
}

/// `k_0 s(0) + Σ k_t (s(-t) + s(t))` for `BLOCK` neighboring columns; `samples(t)` starts at the block, shifted by t.
#[inline(always)]
pub(super) fn weighted_sum<'a>(kernel: &[f32], samples: impl Fn(isize) -> &'a [f32]) -> [f32; BLOCK] {
    let mut sums = [0.0f32; BLOCK];
    let center = &samples(0)[..BLOCK];
    for i in 0..BLOCK {
        sums[i] = kernel[0] * center[i];
    }
    for (t, &weight) in kernel.iter().enumerate().skip(1) {
        let before = &samples(-(t as isize))[..BLOCK];
        let after = &samples(t as isize)[..BLOCK];
        for i in 0..BLOCK {
            sums[i] += weight * (before[i] + after[i]);
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use imaging::{Plane, Raster, Rgb8};
    use spec::Hscm;

    use super::super::recipe::FilterRecipe;
    use super::*;

    #[test]
    fn the_width_of_the_vector_unit_changes_no_bit() {
        let picture = Rgb8::from_fn(131, 97, |x, y| [(x * y) as u8, (7 * x) as u8, (3 * y) as u8]);
        let luma = Luma::new(&Raster::from(picture));
        let filter = Filter::new(&Hscm::default(), 131);
        let recipe =
            FilterRecipe::separable((131, 97), &filter).expect("the cutoff is separable at this size");
        let FilterRecipe::Separable(kernels) = &recipe else {
            panic!("{recipe:?} is not separable");
        };
        let mut plain = Plane::filled(131, 97, 0.0f32);
        let mut finish = |y: usize, row: &[f32]| plain.row_mut(y).copy_from_slice(row);
        sweep(&luma, &filter, kernels, &mut finish);
        let dispatched = super::super::filtered_by(&recipe, &luma, &filter);
        assert!(
            plain
                .data()
                .iter()
                .zip(dispatched.data())
                .all(|(a, b)| a.to_bits() == b.to_bits())
        );
    }
}
