//! The fastest variant: the circular Gaussian on a picture of half the width and half the height.
//!
//! A Gaussian several pixels wide removes the upper half of the frequencies, so it can be computed on every second
//! sample of every second row: a binomial of seven (`cos⁶(ω/2)`) before decimation, the Gaussian, and the same binomial
//! to interpolate. The kernel of the Gaussian is divided by the responses of both binomials, which makes frequencies up
//! to a quarter of the sampling rate exact. The remaining error is aliasing of at most `0.168 / σ⁶` of the strongest
//! component, σ in pixels: [`aliasing`].
//!
//! One sweep down the picture with rings of rows stays within the caches.

use imaging::reflected;

use super::logarithm::Logarithm;
use super::padding::padded_side;
use super::parameters::Filter;
use super::recipe::PassKernels;
use super::separable::{BLOCK, RowRing, weighted_sum};
use crate::methods::hscm::luma::Luma;

/// Reach of the binomial, in samples.
pub(super) const REACH: usize = 3;

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
    let (padded, radius) = (padded_side(height), kernels.y.len() - 1);
    let mut narrowing = Narrowing::new(luma, filter.eps);
    let half = narrowing.half;
    let stride = half.next_multiple_of(BLOCK);
    let mut line = vec![0.0f32; stride + 2 * (kernels.x.len() - 1)];
    // Rings of rows. The first three count rows from `above` rows over the picture, on a circle of `padded` rows.
    let above = 2 * (radius + 1) + REACH;
    let mut logs = RowRing::new(2 * radius + 8, width);
    let mut narrow = RowRing::new(2 * REACH + 1, half);
    let mut small = RowRing::new(2 * radius + 1, stride);
    let mut wide = RowRing::new(4, width);
    let mut row = vec![0.0f32; width];
    let mut ready = 0;
    for step in 0..height.div_ceil(2) + 2 * radius + 3 {
        while ready <= 2 * step + 2 * REACH {
            // Several turns above a picture smaller than the window.
            let position = (ready + padded * above.div_ceil(padded) - above) % padded;
            narrowing.run(position, logs.row_mut(ready), narrow.row_mut(ready));
            ready += 1;
        }
        let rows = std::array::from_fn(|i| narrow.row(2 * step + i));
        blur_row(rows, &kernels.x, &mut line, half, small.row_mut(step));
        let Some(filled) = step.checked_sub(2 * radius) else {
            continue;
        };
        let center = filled + radius;
        widen_row(&small, center, &kernels.y, &mut line, half, wide.row_mut(filled));
        let Some(pair) = filled.checked_sub(3) else {
            continue;
        };
        for y in (2 * pair..height).take(2) {
            let rows = std::array::from_fn(|i| wide.row(pair + i));
            upsampled_row(rows, y % 2, &mut row);
            for (x, &log) in row.iter_mut().zip(logs.row(y + above)) {
                *x = gain * log - drop * *x;
            }
            finish(y, &row);
        }
    }
}

/// Computes logarithms and decimated rows.
pub(super) struct Narrowing<'a> {
    luma: &'a Luma,
    logarithm: Logarithm,
    /// Columns of the picture that follow it on the padded circle.
    beyond: Vec<usize>,
    line: Vec<f32>,
    /// Even samples with their neighbors on the circle; odd ones likewise.
    even: Vec<f32>,
    odd: Vec<f32>,
    /// Samples of a narrow row.
    pub(super) half: usize,
}

impl<'a> Narrowing<'a> {
    pub(super) fn new(luma: &'a Luma, eps: f64) -> Self {
        let width = luma.codes().width();
        let padded = padded_side(width);
        Self {
            luma,
            logarithm: Logarithm::new(luma, eps),
            beyond: (width..padded).map(|x| reflected(x as isize, width)).collect(),
            line: vec![0.0; padded],
            even: vec![0.0; padded / 2 + 2 * REACH],
            odd: vec![0.0; padded / 2 + 2 * REACH],
            half: padded / 2,
        }
    }

    /// The row at a position of the padded circle.
    #[inline(always)]
    pub(super) fn run(&mut self, position: usize, logs: &mut [f32], narrow: &mut [f32]) {
        let (width, height) = self.luma.codes().size();
        let y = reflected(position as isize, height);
        self.logarithm.row(self.luma.codes().row(y), logs);
        self.line[..width].copy_from_slice(logs);
        for (sample, column) in self.line[width..].iter_mut().zip(&self.beyond) {
            *sample = logs[*column];
        }
        let apart = self.even[REACH..].iter_mut().zip(&mut self.odd[REACH..]);
        for ((even, odd), pair) in apart.zip(self.line.chunks_exact(2)) {
            (*even, *odd) = (pair[0], pair[1]);
        }
        close(&mut self.even, REACH);
        close(&mut self.odd, REACH);
        binomial(&self.even, &self.odd, narrow);
    }
}

/// Every second row, blurred along the row.
#[inline(always)]
fn blur_row(rows: [&[f32]; 7], kernel: &[f32], line: &mut [f32], half: usize, small: &mut [f32]) {
    let radius = kernel.len() - 1;
    binomial_of_rows(rows, &mut line[radius..radius + half]);
    blur_line(kernel, line, half, small);
}

/// Blurs a circle of `half` samples. In `line` they follow room for as many neighbors as the kernel reaches.
#[inline(always)]
pub(super) fn blur_line(kernel: &[f32], line: &mut [f32], half: usize, small: &mut [f32]) {
    let radius = kernel.len() - 1;
    close(&mut line[..half + 2 * radius], radius);
    for (block, out) in small.chunks_exact_mut(BLOCK).enumerate() {
        let window = &line[block * BLOCK..][..BLOCK + 2 * radius];
        out.copy_from_slice(&weighted_sum(kernel, |offset| {
            &window[radius.wrapping_add_signed(offset)..]
        }));
    }
}

/// Blurs down the columns around row `center` of the ring and interpolates along the row.
#[inline(always)]
pub(super) fn widen_row(
    small: &RowRing,
    center: usize,
    kernel: &[f32],
    line: &mut [f32],
    half: usize,
    wide: &mut [f32],
) {
    let radius = kernel.len() - 1;
    let rows_around = small.rows_around(center, radius);
    for block in (0..half).step_by(BLOCK) {
        let sums = weighted_sum(kernel, |offset| {
            &rows_around[radius.wrapping_add_signed(offset)][block..]
        });
        let end = (block + BLOCK).min(half);
        line[REACH + block..REACH + end].copy_from_slice(&sums[..end - block]);
    }
    let line = &mut line[..half + 2 * REACH];
    close(line, REACH);
    let rows: [&[f32]; 4] = std::array::from_fn(|i| &line[REACH + i - 1..][..half]);
    let pairs = wide.len() / 2;
    let [a, b, c, d] = rows.map(|row| &row[..pairs]);
    for (j, pair) in wide.chunks_exact_mut(2).enumerate() {
        let samples = [a[j], b[j], c[j], d[j]];
        (pair[0], pair[1]) = (even_sample(samples), odd_sample(samples));
    }
    if wide.len() % 2 == 1 {
        wide[2 * pairs] = even_sample(rows.map(|row| row[pairs]));
    }
}

/// Wraps `reach` samples around both ends of a circle.
#[inline(always)]
fn close(line: &mut [f32], reach: usize) {
    let n = line.len() - 2 * reach;
    for i in 0..reach {
        line[i] = line[reach + (i + n * reach - reach) % n];
        line[reach + n + i] = line[reach + i % n];
    }
}

/// The binomial of seven around every even sample.
#[inline(always)]
fn binomial(even: &[f32], odd: &[f32], out: &mut [f32]) {
    let n = out.len();
    let even: [&[f32]; 3] = std::array::from_fn(|i| &even[REACH + i - 1..][..n]);
    let odd: [&[f32]; 4] = std::array::from_fn(|i| &odd[REACH + i - 2..][..n]);
    binomial_of_rows([odd[0], even[0], odd[1], even[1], odd[2], even[2], odd[3]], out);
}

#[inline(always)]
fn binomial_of_rows(rows: [&[f32]; 7], out: &mut [f32]) {
    let n = out.len();
    let rows = rows.map(|row| &row[..n]);
    for x in 0..n {
        out[x] = (20.0 * rows[3][x]
            + 15.0 * (rows[2][x] + rows[4][x])
            + 6.0 * (rows[1][x] + rows[5][x])
            + (rows[0][x] + rows[6][x]))
            / 64.0;
    }
}

/// The sample at a kept position, from that one (1) and its neighbors.
#[inline(always)]
fn even_sample(samples: [f32; 4]) -> f32 {
    (20.0 * samples[1] + 6.0 * (samples[0] + samples[2])) / 32.0
}

/// The sample between kept positions 1 and 2.
#[inline(always)]
fn odd_sample(samples: [f32; 4]) -> f32 {
    (15.0 * (samples[1] + samples[2]) + (samples[0] + samples[3])) / 32.0
}

#[inline(always)]
fn upsampled_row(rows: [&[f32]; 4], parity: usize, out: &mut [f32]) {
    let n = out.len();
    let rows = rows.map(|row| &row[..n]);
    if parity == 0 {
        for x in 0..n {
            out[x] = even_sample([rows[0][x], rows[1][x], rows[2][x], rows[3][x]]);
        }
    } else {
        for x in 0..n {
            out[x] = odd_sample([rows[0][x], rows[1][x], rows[2][x], rows[3][x]]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::response::aliasing;
    use super::*;

    #[test]
    fn a_circle_continues_at_both_ends_however_short_it_is() {
        let mut line = vec![0.0, 0.0, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0];
        close(&mut line, 3);
        assert_eq!(line, [2.0, 1.0, 2.0, 1.0, 2.0, 1.0, 2.0, 1.0]);
    }

    #[test]
    fn a_constant_passes_and_the_highest_frequency_does_not() {
        let mut out = [0.0; 4];
        binomial(&[3.0; 10], &[3.0; 10], &mut out);
        assert_eq!(out, [3.0; 4]);
        binomial(&[3.0; 10], &[-3.0; 10], &mut out);
        assert_eq!(out, [0.0; 4]);
        assert_eq!((even_sample([2.0; 4]), odd_sample([2.0; 4])), (2.0, 2.0));
    }

    #[test]
    fn the_bound_on_aliasing_is_the_maximum_of_its_formula() {
        for sigma in [3.0, 5.0, 8.0] {
            let gain = |delta: f64| (delta / 2.0).sin().powi(6) * (-0.5 * (delta * sigma).powi(2)).exp();
            let most = (0..1570).map(|i| gain(f64::from(i) / 1000.0)).fold(0.0, f64::max);
            assert!(
                most <= aliasing(sigma) && most > 0.8 * aliasing(sigma),
                "{sigma}: {most}"
            );
        }
    }
}
