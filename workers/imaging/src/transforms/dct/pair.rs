//! The fast transform: two real planes are the real and the imaginary part of one complex plane.
//!
//! The cosine transform is linear, so one complex FFT per axis serves both. Samples are in folded order on both axes,
//! see [`Folding`](super::Folding). Rows and columns of coefficients are passed on singly while they are in the nearest cache: a
//! complete plane does not fit there, and writing and reading it would take longer than the FFT.

use super::Direction;
use super::axis::{AxisBuffers, AxisTransform};
use super::butterfly;
use super::group::{ColumnGroup, TILE};
use crate::fft::Complex;
use crate::{cancel, vectorized};

/// Transforms of pairs of f32 planes of one size. Same scale as [`Dct2`](super::Dct2).
pub struct PairDct {
    width: usize,
    height: usize,
    rows: AxisTransform,
    columns: AxisTransform,
    /// Between the axes: row-major, folded.
    plane: Vec<Complex<f32>>,
    /// Contiguous copies of the current columns.
    tile: Vec<Complex<f32>>,
    buffers: AxisBuffers,
}

impl PairDct {
    /// Plans the transforms of planes of `width × height`.
    #[must_use]
    pub fn new(width: usize, height: usize) -> Self {
        let rows = AxisTransform::new(width);
        let columns = AxisTransform::new(height);
        Self {
            width,
            height,
            rows,
            columns,
            plane: vec![Complex::default(); width * height],
            tile: vec![Complex::default(); 2 * TILE * height],
            buffers: AxisBuffers::default(),
        }
    }

    /// Columns and rows of the planes.
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// Size of the buffers in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(self.plane.as_slice()) + size_of_val(self.tile.as_slice())
    }

    /// Transforms two planes to the first `columns` columns of their spectra, for callers that need low frequencies
    /// only. `fill` writes a row of both in folded order, by its position in that order; `take` receives each column p
    /// of coefficients, with ascending frequencies q, in any order.
    pub fn forward(
        &mut self,
        mut fill: impl FnMut(usize, &mut [Complex<f32>]),
        columns: usize,
        mut take: impl FnMut(usize, &[Complex<f32>]),
    ) {
        if self.plane.is_empty() {
            return;
        }
        for (y, row) in self.plane.chunks_exact_mut(self.width).enumerate() {
            cancel::check();
            fill(y, row);
            self.rows.process(row, Direction::Forward, &mut self.buffers);
        }
        for group in ColumnGroup::select_below(columns, self.width) {
            let lines = &mut self.tile[..group.columns() * self.height];
            group.load(&self.plane, self.width, lines, self.height);
            vectorized!(group.join(Direction::Forward, &self.rows.twiddles, lines, self.height));
            let lines = &mut lines[..group.below_limit(columns) * self.height];
            self.columns.process(lines, Direction::Forward, &mut self.buffers);
            for (p, line) in group.places().zip(lines.chunks_exact_mut(self.height)) {
                vectorized!(butterfly::along(Direction::Forward, &self.columns.twiddles, line));
                take(p, line);
            }
        }
    }

    /// Transforms two spectra, with zeros beyond the first `columns` columns, back to planes. `fill` writes each of
    /// those columns p of coefficients, in any order; `take` receives the rows of both planes, with their position in
    /// folded order.
    pub fn inverse(
        &mut self,
        mut fill: impl FnMut(usize, &mut [Complex<f32>]),
        columns: usize,
        mut take: impl FnMut(usize, &[Complex<f32>]),
    ) {
        if self.plane.is_empty() {
            return;
        }
        for group in ColumnGroup::select_below(self.width, self.width) {
            let lines = &mut self.tile[..group.columns() * self.height];
            let (some, none) = lines.split_at_mut(group.below_limit(columns) * self.height);
            for (p, line) in group.places().zip(some.chunks_exact_mut(self.height)) {
                fill(p, line);
                vectorized!(butterfly::along(Direction::Inverse, &self.columns.twiddles, line));
            }
            self.columns.process(some, Direction::Inverse, &mut self.buffers);
            none.fill(Complex::default());
            vectorized!(group.join(Direction::Inverse, &self.rows.twiddles, lines, self.height));
            group.store(lines, self.height, &mut self.plane, self.width);
        }
        let scale = 1.0 / (self.width * self.height) as f32;
        for (y, row) in self.plane.chunks_exact_mut(self.width).enumerate() {
            self.rows.process(row, Direction::Inverse, &mut self.buffers);
            vectorized!(row.iter_mut().for_each(|value| *value = value.scale(scale)));
            take(y, row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{SIZES, noise};
    use super::*;
    use crate::dct::{Dct2, Folding};

    #[test]
    fn a_pair_is_transformed_as_each_plane_alone() {
        for (width, height) in SIZES {
            let planes = [noise(width, height, 1), noise(width, height, 2)];
            let mut pair = PairDct::new(width, height);
            let folded = planes.each_ref().map(|plane| {
                let single: Vec<f32> = plane.iter().map(|&v| v as f32).collect();
                let mut folded = vec![0.0; single.len()];
                Folding::new(width, height).fold(&single, &mut folded);
                folded
            });
            let mut samples: Vec<_> = folded[0]
                .iter()
                .zip(&folded[1])
                .map(|(&a, &b)| Complex::new(a, b))
                .collect();
            let mut spectrum = vec![Complex::new(f32::NAN, f32::NAN); samples.len()];
            pair.forward(
                |y, row| row.copy_from_slice(&samples[y * width..][..width]),
                width,
                |p, column| spectrum[p * height..][..height].copy_from_slice(column),
            );
            let scale = ((width * height) as f64).sqrt();
            for (part, mut plane) in planes.clone().into_iter().enumerate() {
                Dct2::new(width, height).forward(&mut plane);
                for (index, expected) in plane.iter().enumerate() {
                    let value = spectrum[index % width * height + index / width];
                    let error = (f64::from([value.re, value.im][part]) - expected).abs();
                    assert!(error < 1e-6 * scale, "{width}×{height} at {index}: {error:e}");
                }
            }
            pair.inverse(
                |p, column| column.copy_from_slice(&spectrum[p * height..][..height]),
                width,
                |y, row| samples[y * width..][..width].copy_from_slice(row),
            );
            for (part, plane) in planes.iter().enumerate() {
                let folding = Folding::new(width, height);
                let mut back = vec![0.0; samples.len()];
                for (place, row) in samples.chunks_exact(width).enumerate() {
                    let y = folding.row(place);
                    folding.unfold_row(row, |v| [v.re, v.im][part], &mut back[y * width..][..width]);
                }
                let worst = back
                    .iter()
                    .zip(plane)
                    .map(|(b, p)| (f64::from(*b) - p).abs())
                    .fold(0.0, f64::max);
                assert!(worst < 1e-6, "{width}×{height} and back: {worst:e}");
            }
        }
    }

    #[test]
    fn columns_that_are_not_asked_for_do_not_change_the_others() {
        for (width, height) in SIZES {
            let sample = |i: usize| Complex::new((i % 7) as f32, (i % 5) as f32 - 2.0);
            let samples: Vec<_> = (0..width * height).map(sample).collect();
            let mut pair = PairDct::new(width, height);
            let mut spectrum = |columns: usize| {
                let mut spectrum = vec![Complex::default(); samples.len()];
                pair.forward(
                    |y, row| row.copy_from_slice(&samples[y * width..][..width]),
                    columns,
                    |p, column| spectrum[p * height..][..height].copy_from_slice(column),
                );
                spectrum
            };
            let whole = spectrum(width);
            for columns in 0..=width {
                let mut cut = whole.clone();
                cut[columns * height..].fill(Complex::default());
                assert_eq!(spectrum(columns), cut, "{columns} of {width}×{height}");
            }
            let mut planes = |spectrum: &[Complex<f32>], columns: usize| {
                let mut planes = samples.clone();
                pair.inverse(
                    |p, column| column.copy_from_slice(&spectrum[p * height..][..height]),
                    columns,
                    |y, row| planes[y * width..][..width].copy_from_slice(row),
                );
                planes
            };
            for columns in 0..=width {
                let mut cut = whole.clone();
                cut[columns * height..].fill(Complex::default());
                let expected = planes(&cut, width);
                for (one, other) in planes(&whole, columns).iter().zip(&expected) {
                    assert!((one - other).norm() < 1e-5, "{columns} of {width}×{height}");
                }
            }
        }
    }
}
