//! The matting Laplacian in f64.

use imaging::{Plane, vectorized};

use super::windows::{RIM, STEPS, each_row};

/// A symmetric matrix over the pixels of a picture with a reach of two pixels. Planes have a rim of zeros.
pub(super) struct Laplacian {
    pub(super) width: usize,
    pub(super) height: usize,
    /// For each of [`STEPS`] the coefficient of each pixel.
    coefficients: [Vec<f64>; STEPS.len()],
}

impl Laplacian {
    /// The matrix of a picture of at least 3 × 3 pixels.
    pub(super) fn new(channels: &[Plane<u8>; 3]) -> Self {
        let (width, height) = channels[0].size();
        let mut laplacian = Self {
            width,
            height,
            coefficients: std::array::from_fn(|_| vec![0.0; (width + 2 * RIM) * (height + 2 * RIM)]),
        };
        let stride = laplacian.stride();
        each_row::<f64>(channels, |y, row| {
            for (plane, row) in laplacian.coefficients.iter_mut().zip(row) {
                plane[(y + RIM) * stride..][..stride].copy_from_slice(row);
            }
        });
        laplacian
    }

    /// Columns of a plane with its rim.
    pub(super) fn stride(&self) -> usize {
        self.width + 2 * RIM
    }

    /// Position of a pixel in a plane with its rim.
    pub(super) fn position(&self, x: usize, y: usize) -> usize {
        (y + RIM) * self.stride() + x + RIM
    }

    /// The coefficients of a pixel, in the order of [`STEPS`].
    pub(super) fn of_pixel(&self, x: usize, y: usize) -> [f64; STEPS.len()] {
        let position = self.position(x, y);
        self.coefficients.each_ref().map(|plane| plane[position])
    }

    /// The main diagonal.
    pub(super) fn diagonal(&self) -> &[f64] {
        &self.coefficients[0]
    }

    /// `out = (L + λ E) x`, both with their rim. The rim of `x` must be 0; that of `out` is unchanged.
    pub(super) fn apply(&self, closeness: f64, x: &[f64], out: &mut [f64]) {
        vectorized!(apply(self, closeness, x, out));
    }
}

#[inline(always)]
fn apply(laplacian: &Laplacian, closeness: f64, x: &[f64], out: &mut [f64]) {
    let (width, stride) = (laplacian.width, laplacian.stride());
    for y in 0..laplacian.height {
        let row = laplacian.position(0, y);
        let out = &mut out[row..row + width];
        let (own, x_own) = (&laplacian.coefficients[0][row..row + width], &x[row..row + width]);
        for i in 0..width {
            out[i] = (own[i] + closeness) * x_own[i];
        }
        for (plane, (columns, rows)) in laplacian.coefficients.iter().zip(STEPS).skip(1) {
            let reach = rows as isize * stride as isize + columns;
            let (after, before) = (row.wrapping_add_signed(reach), row.wrapping_add_signed(-reach));
            let (to_after, x_after) = (&plane[row..row + width], &x[after..after + width]);
            let (to_before, x_before) = (&plane[before..before + width], &x[before..before + width]);
            for i in 0..width {
                out[i] += to_after[i] * x_after[i] + to_before[i] * x_before[i];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_sum_to_nothing() {
        let channel = |seed: usize| Plane::from_fn(9, 7, |x, y| ((x * x * seed + 31 * y) % 251) as u8);
        let laplacian = Laplacian::new(&[channel(3), channel(5), channel(17)]);
        let mut ones = vec![0.0; laplacian.diagonal().len()];
        for y in 0..7 {
            for x in 0..9 {
                ones[laplacian.position(x, y)] = 1.0;
            }
        }
        let mut sums = vec![0.0; ones.len()];
        laplacian.apply(0.0, &ones, &mut sums);
        assert!(sums.iter().all(|sum| sum.abs() < 1e-9));
        assert!(laplacian.of_pixel(4, 3)[0] > 1.0);
    }
}
