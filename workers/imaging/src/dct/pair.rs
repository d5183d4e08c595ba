//! The transform for speed: two real planes travel as the real and the imaginary part of one complex plane.
//!
//! The cosine transform is linear, so one complex FFT per axis serves both. Samples come in *folded* order on both axes
//! (those of even index forward, then those of odd index backward), which a user who transforms the same source several
//! times establishes once; the spectrum is column-major, so that each axis is transformed in contiguous memory with a
//! single transposition.

use std::sync::Arc;

use crate::simd::vectorised;
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

/// Square of the transposition: 16 complex numbers are two cache lines.
const TILE: usize = 16;

/// Transforms of pairs of f32 planes of one size. Same scale as [`Dct2`](super::Dct2).
pub struct PairDct {
    width: usize,
    height: usize,
    rows: Axis,
    columns: Axis,
    scratch: Vec<Complex<f32>>,
}

struct Axis {
    forward: Arc<dyn Fft<f32>>,
    inverse: Arc<dyn Fft<f32>>,
    /// `exp(-iπk/2N)`.
    twiddles: Vec<Complex<f32>>,
}

impl Axis {
    fn new(planner: &mut FftPlanner<f32>, length: usize) -> Self {
        let twiddle = |k: usize| {
            let angle = -std::f64::consts::FRAC_PI_2 * k as f64 / length as f64;
            Complex::new(angle.cos() as f32, angle.sin() as f32)
        };
        Self {
            forward: planner.plan_fft_forward(length),
            inverse: planner.plan_fft_inverse(length),
            twiddles: (0..length).map(twiddle).collect(),
        }
    }
}

impl PairDct {
    /// Plans the transforms of planes of `width × height`.
    #[must_use]
    pub fn new(width: usize, height: usize) -> Self {
        let mut planner = FftPlanner::new();
        let rows = Axis::new(&mut planner, width);
        let columns = Axis::new(&mut planner, height);
        let needed = [&rows, &columns].map(|axis| {
            axis.forward
                .get_inplace_scratch_len()
                .max(axis.inverse.get_inplace_scratch_len())
        });
        let scratch = vec![Complex::default(); needed[0].max(needed[1])];
        Self {
            width,
            height,
            rows,
            columns,
            scratch,
        }
    }

    /// Columns and rows of the planes.
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// Brings a row-major plane into folded order.
    ///
    /// # Panics
    /// When a plane is of another size.
    pub fn fold(&self, plane: &[f32], folded: &mut [f32]) {
        self.expect_size(plane.len());
        self.expect_size(folded.len());
        for (y, row) in plane.chunks_exact(self.width.max(1)).enumerate() {
            let place = folded_index(y, self.height);
            let line = &mut folded[place * self.width..(place + 1) * self.width];
            let (evens, odds) = line.split_at_mut(self.width.div_ceil(2));
            evens
                .iter_mut()
                .zip(row.iter().step_by(2))
                .for_each(|(to, &from)| *to = from);
            odds.iter_mut()
                .rev()
                .zip(row.iter().skip(1).step_by(2))
                .for_each(|(to, &from)| *to = from);
        }
    }

    /// Undoes [`PairDct::fold`].
    ///
    /// # Panics
    /// When a plane is of another size.
    pub fn unfold(&self, folded: &[f32], plane: &mut [f32]) {
        self.expect_size(plane.len());
        self.expect_size(folded.len());
        for (y, row) in plane.chunks_exact_mut(self.width.max(1)).enumerate() {
            let place = folded_index(y, self.height);
            let line = &folded[place * self.width..(place + 1) * self.width];
            let (evens, odds) = line.split_at(self.width.div_ceil(2));
            row.iter_mut()
                .step_by(2)
                .zip(evens)
                .for_each(|(to, &from)| *to = from);
            row.iter_mut()
                .skip(1)
                .step_by(2)
                .zip(odds.iter().rev())
                .for_each(|(to, &from)| *to = from);
        }
    }

    /// From two planes in folded order (overwritten) to their spectra, column-major: coefficient (p, q) is at
    /// `p · height + q`.
    ///
    /// # Panics
    /// When a plane is of another size.
    pub fn forward(&mut self, folded: &mut [Complex<f32>], spectrum: &mut [Complex<f32>]) {
        self.expect_size(folded.len());
        self.expect_size(spectrum.len());
        if folded.is_empty() {
            return;
        }
        self.rows.forward.process_with_scratch(folded, &mut self.scratch);
        transpose(folded, spectrum, self.width, self.height);
        self.columns
            .forward
            .process_with_scratch(spectrum, &mut self.scratch);
        let (rows, columns, height) = (&self.rows.twiddles, &self.columns.twiddles, self.height);
        vectorised(
            #[inline(always)]
            || {
                across(spectrum, rows, height, forward_butterfly);
                for line in spectrum.chunks_exact_mut(height) {
                    across(line, columns, 1, forward_butterfly);
                }
            },
        );
    }

    /// From two spectra (overwritten) back to the planes in folded order.
    ///
    /// # Panics
    /// When a plane is of another size.
    pub fn inverse(&mut self, spectrum: &mut [Complex<f32>], folded: &mut [Complex<f32>]) {
        self.expect_size(folded.len());
        self.expect_size(spectrum.len());
        if folded.is_empty() {
            return;
        }
        let (rows, columns, height) = (&self.rows.twiddles, &self.columns.twiddles, self.height);
        vectorised(
            #[inline(always)]
            || {
                for line in spectrum.chunks_exact_mut(height) {
                    across(line, columns, 1, inverse_butterfly);
                }
                across(spectrum, rows, height, inverse_butterfly);
            },
        );
        self.columns
            .inverse
            .process_with_scratch(spectrum, &mut self.scratch);
        transpose(spectrum, folded, self.height, self.width);
        self.rows.inverse.process_with_scratch(folded, &mut self.scratch);
        let scale = 1.0 / (self.width * self.height) as f32;
        folded.iter_mut().for_each(|value| *value = value.scale(scale));
    }

    fn expect_size(&self, length: usize) {
        assert_eq!(
            length,
            self.width * self.height,
            "a plane of {}×{}",
            self.width,
            self.height
        );
    }
}

/// Where a sample stands in folded order.
fn folded_index(index: usize, length: usize) -> usize {
    if index.is_multiple_of(2) {
        index / 2
    } else {
        length - 1 - index / 2
    }
}

/// Row-major `width × height` to row-major `height × width`.
fn transpose(from: &[Complex<f32>], to: &mut [Complex<f32>], width: usize, height: usize) {
    for top in (0..height).step_by(TILE) {
        for left in (0..width).step_by(TILE) {
            for x in left..(left + TILE).min(width) {
                let bottom = (top + TILE).min(height);
                let line = &mut to[x * height + top..x * height + bottom];
                for (value, y) in line.iter_mut().zip(top..bottom) {
                    *value = from[y * width + x];
                }
            }
        }
    }
}

/// Applies a butterfly to lines k and N−k of `length` numbers each, k = 1 … N/2; line 0 stays as it is.
#[inline(always)]
fn across(
    lines: &mut [Complex<f32>],
    twiddles: &[Complex<f32>],
    length: usize,
    butterfly: impl Fn(Complex<f32>, &mut Complex<f32>, &mut Complex<f32>),
) {
    let count = twiddles.len();
    for k in 1..count.div_ceil(2) {
        let (low, high) = lines.split_at_mut((count - k) * length);
        for (one, other) in low[k * length..(k + 1) * length]
            .iter_mut()
            .zip(&mut high[..length])
        {
            butterfly(twiddles[k], one, other);
        }
    }
    if count > 1 && count.is_multiple_of(2) {
        let middle = count / 2;
        for value in &mut lines[middle * length..(middle + 1) * length] {
            let mut mirrored = *value;
            butterfly(twiddles[middle], value, &mut mirrored);
        }
    }
}

/// `X[k] = ½(w V[k] + w̄ V[N−k])`, `X[N−k] = ½i (w V[k] − w̄ V[N−k])`.
#[inline(always)]
fn forward_butterfly(twiddle: Complex<f32>, one: &mut Complex<f32>, other: &mut Complex<f32>) {
    let half = twiddle.scale(0.5);
    let (a, b) = (half * *one, half.conj() * *other);
    *one = a + b;
    *other = Complex::new(b.im - a.im, a.re - b.re);
}

/// `V[k] = w̄ (X[k] − i X[N−k])`, `V[N−k] = w (X[k] + i X[N−k])`.
#[inline(always)]
fn inverse_butterfly(twiddle: Complex<f32>, one: &mut Complex<f32>, other: &mut Complex<f32>) {
    let (x, mirrored) = (*one, *other);
    *one = twiddle.conj() * Complex::new(x.re + mirrored.im, x.im - mirrored.re);
    *other = twiddle * Complex::new(x.re - mirrored.im, x.im + mirrored.re);
}

#[cfg(test)]
mod tests {
    use super::super::tests::{SIZES, noise};
    use super::*;
    use crate::dct::Dct2;

    #[test]
    fn a_pair_is_transformed_as_each_plane_alone() {
        for (width, height) in SIZES {
            let planes = [noise(width, height, 1), noise(width, height, 2)];
            let mut pair = PairDct::new(width, height);
            let folded = planes.each_ref().map(|plane| {
                let single: Vec<f32> = plane.iter().map(|&v| v as f32).collect();
                let mut folded = vec![0.0; single.len()];
                pair.fold(&single, &mut folded);
                folded
            });
            let mut samples: Vec<_> = folded[0]
                .iter()
                .zip(&folded[1])
                .map(|(&a, &b)| Complex::new(a, b))
                .collect();
            let mut spectrum = vec![Complex::default(); samples.len()];
            pair.forward(&mut samples, &mut spectrum);
            let scale = ((width * height) as f64).sqrt();
            for (part, mut plane) in planes.clone().into_iter().enumerate() {
                Dct2::new(width, height).forward(&mut plane);
                for (index, expected) in plane.iter().enumerate() {
                    let value = spectrum[index % width * height + index / width];
                    let error = (f64::from([value.re, value.im][part]) - expected).abs();
                    assert!(error < 1e-6 * scale, "{width}×{height} at {index}: {error:e}");
                }
            }
            pair.inverse(&mut spectrum, &mut samples);
            for (part, plane) in planes.iter().enumerate() {
                let folded: Vec<f32> = samples.iter().map(|v| [v.re, v.im][part]).collect();
                let mut back = vec![0.0; folded.len()];
                pair.unfold(&folded, &mut back);
                let worst = back
                    .iter()
                    .zip(plane)
                    .map(|(b, p)| (f64::from(*b) - p).abs())
                    .fold(0.0, f64::max);
                assert!(worst < 1e-6, "{width}×{height} and back: {worst:e}");
            }
        }
    }
}
