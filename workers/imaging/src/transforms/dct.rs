//! The two-dimensional cosine transform of any size.
//!
//! Forward, type II, not normalized: `X[q][p] = Σ_y Σ_x x[y][x] cos(π p (x+½)/W) cos(π q (y+½)/H)`, with an exact
//! inverse. A plane under this transform is a mirror box: half-sample symmetric on all sides, so that a convolution
//! with an even kernel becomes a product, without wrap-around and without padding.
//!
//! Each pass is a complex FFT of the same length (Makhoul 1980, "A fast cosine transform in one and two dimensions")
//! that transforms two real lines together. [`Dct2`] is the plain variant in f64, [`PairDct`] the fast one in f32.

mod axis;
mod butterfly;
mod folding;
mod group;
mod pair;
mod prime;

pub use folding::Folding;
pub use pair::PairDct;

use crate::cancel;
use crate::fft::{self, Complex, Ffts};

/// The sign of the exponent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Direction {
    /// Minus.
    Forward,
    /// Plus.
    Inverse,
}

/// Columns gathered together by a vertical pass: 16 f32 fill a cache line.
const COLUMNS: usize = 16;

/// The transforms of one frame size, with their buffers.
pub struct Dct2 {
    width: usize,
    height: usize,
    rows: LineTransform,
    columns: LineTransform,
    block: Vec<f64>,
}

impl Dct2 {
    /// Plans the transforms of planes of `width × height`.
    #[must_use]
    pub fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            rows: LineTransform::new(width),
            columns: LineTransform::new(height),
            block: vec![0.0; height * COLUMNS],
        }
    }

    /// Columns and rows of the planes.
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// Transforms a row-major plane in place.
    ///
    /// # Panics
    /// If the plane has another size.
    pub fn forward(&mut self, plane: &mut [f64]) {
        self.both_axes(plane, LineTransform::forward);
    }

    /// Inverts [`Dct2::forward`] in place.
    ///
    /// # Panics
    /// If the plane has another size.
    pub fn inverse(&mut self, plane: &mut [f64]) {
        self.both_axes(plane, LineTransform::inverse);
    }

    fn both_axes(&mut self, plane: &mut [f64], pass: fn(&mut LineTransform, &mut [f64], &mut [f64])) {
        assert_eq!(
            plane.len(),
            self.width * self.height,
            "a plane of {}×{}",
            self.width,
            self.height
        );
        if plane.is_empty() {
            return;
        }
        for pair in plane.chunks_mut(2 * self.width) {
            cancel::check();
            let (first, second) = pair.split_at_mut(self.width);
            pass(&mut self.rows, first, second);
        }
        for left in (0..self.width).step_by(COLUMNS) {
            cancel::check();
            let count = COLUMNS.min(self.width - left);
            for (y, row) in plane.chunks_exact(self.width).enumerate() {
                for (x, &sample) in row[left..left + count].iter().enumerate() {
                    self.block[x * self.height + y] = sample;
                }
            }
            for pair in self.block[..count * self.height].chunks_mut(2 * self.height) {
                let (first, second) = pair.split_at_mut(self.height);
                pass(&mut self.columns, first, second);
            }
            for (y, row) in plane.chunks_exact_mut(self.width).enumerate() {
                for (x, sample) in row[left..left + count].iter_mut().enumerate() {
                    *sample = self.block[x * self.height + y];
                }
            }
        }
    }
}

/// Transforms of lines of one length, two at a time; the second may be empty.
struct LineTransform {
    length: usize,
    ffts: Ffts<f64>,
    /// `exp(-iπk/2N)`.
    twiddles: Vec<Complex<f64>>,
    buffer: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
}

impl LineTransform {
    fn new(length: usize) -> Self {
        let ffts = fft::double(length);
        Self {
            length,
            twiddles: (0..length).map(|k| twiddle(k, length)).collect(),
            buffer: vec![Complex::default(); length],
            scratch: vec![Complex::default(); ffts.scratch],
            ffts,
        }
    }

    /// Even samples forward, then odd samples backward: the order of a mirrored line in the FFT.
    fn place(&self, index: usize) -> usize {
        if index.is_multiple_of(2) {
            index / 2
        } else {
            self.length - 1 - index / 2
        }
    }

    fn forward(&mut self, first: &mut [f64], second: &mut [f64]) {
        for index in 0..self.length {
            let place = self.place(index);
            self.buffer[place] = Complex::new(first[index], second.get(index).copied().unwrap_or(0.0));
        }
        self.ffts
            .forward
            .process_with_scratch(&mut self.buffer, &mut self.scratch);
        for k in 0..self.length {
            let forward = self.buffer[k];
            let mirrored = self.buffer[if k == 0 { 0 } else { self.length - k }].conj();
            let sum = forward + mirrored;
            let difference = forward - mirrored;
            let twiddle = self.twiddles[k];
            first[k] = 0.5 * (sum.re * twiddle.re - sum.im * twiddle.im);
            if let Some(sample) = second.get_mut(k) {
                // difference = 2i V: its real part after division by 2i is im/2, its imaginary part -re/2.
                *sample = 0.5 * (difference.im * twiddle.re + difference.re * twiddle.im);
            }
        }
    }

    fn inverse(&mut self, first: &mut [f64], second: &mut [f64]) {
        let scale = 1.0 / self.length as f64;
        for k in 0..self.length {
            let back = self.twiddles[k].conj() * scale;
            let pair = |line: &[f64]| {
                let mirrored = if k == 0 { 0.0 } else { line[self.length - k] };
                Complex::new(line[k], -mirrored) * back
            };
            let first_pair = pair(first);
            let second_pair = if second.is_empty() {
                Complex::default()
            } else {
                pair(second)
            };
            self.buffer[k] = Complex::new(first_pair.re - second_pair.im, first_pair.im + second_pair.re);
        }
        self.ffts
            .inverse
            .process_with_scratch(&mut self.buffer, &mut self.scratch);
        for index in 0..self.length {
            let place = self.place(index);
            first[index] = self.buffer[place].re;
            if let Some(sample) = second.get_mut(index) {
                *sample = self.buffer[place].im;
            }
        }
    }
}

/// `exp(-iπk/2N)`.
fn twiddle(k: usize, length: usize) -> Complex<f64> {
    let angle = -std::f64::consts::FRAC_PI_2 * k as f64 / length as f64;
    Complex::new(angle.cos(), angle.sin())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    pub(crate) const SIZES: [(usize, usize); 9] = [
        (1, 1),
        (1, 7),
        (7, 1),
        (2, 2),
        (5, 3),
        (13, 17),
        (16, 9),
        (33, 20),
        (41, 12),
    ];

    pub(crate) fn noise(width: usize, height: usize, seed: u64) -> Vec<f64> {
        let stream = Stream::stage(seed, "dct");
        (0..(width * height) as u64)
            .map(|i| stream.unit(i, 0) - 0.5)
            .collect()
    }

    /// The definition, term by term.
    fn definition(width: usize, height: usize, plane: &[f64]) -> Vec<f64> {
        let cosine = |p: usize, x: usize, n: usize| {
            (std::f64::consts::PI * p as f64 * (x as f64 + 0.5) / n as f64).cos()
        };
        let mut transformed = vec![0.0; plane.len()];
        for q in 0..height {
            for p in 0..width {
                for y in 0..height {
                    for x in 0..width {
                        transformed[q * width + p] +=
                            plane[y * width + x] * cosine(p, x, width) * cosine(q, y, height);
                    }
                }
            }
        }
        transformed
    }

    fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn forward_is_the_definition_at_every_size() {
        for (width, height) in SIZES {
            let mut plane = noise(width, height, 3);
            let expected = definition(width, height, &plane);
            Dct2::new(width, height).forward(&mut plane);
            assert!(largest_difference(&plane, &expected) < 1e-11, "{width}×{height}");
        }
    }

    #[test]
    fn inverse_undoes_forward() {
        for (width, height) in SIZES {
            let original = noise(width, height, 3);
            let mut plane = original.clone();
            let mut transform = Dct2::new(width, height);
            transform.forward(&mut plane);
            transform.inverse(&mut plane);
            assert!(largest_difference(&plane, &original) < 1e-13, "{width}×{height}");
        }
    }

    #[test]
    fn a_constant_plane_has_only_its_sum() {
        let mut plane = vec![0.5f64; 12];
        Dct2::new(4, 3).forward(&mut plane);
        assert!((plane[0] - 6.0).abs() < 1e-14);
        assert!(plane[1..].iter().all(|v| v.abs() < 1e-14));
    }
}
