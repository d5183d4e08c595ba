//! Large pictures: the Chebyshev iteration (Golub and Varga 1961; Saad 2003, algorithm 12.1) in f32, several steps per
//! pass.
//!
//! Each window adds a matrix with eigenvalues in 0..=1 to L, and a pixel is in at most nine windows, so the eigenvalues
//! of `A = L + λ E` are in λ..=λ + 9 for every picture. Therefore the steps
//!
//! ```text
//! x_{k+1} = x_k + ρ_k ρ_{k-1} (x_k - x_{k-1}) + 2 ρ_k/δ (b - A x_k)      ρ_k = 1/(2 σ - ρ_{k-1}),  ρ_0 = 1/σ
//! ```
//!
//! with `δ = 9/2`, `σ = (λ + δ)/δ` are known in advance, and so is the share of the residual after k steps: `1/cosh(k
//! acosh σ)`. Conjugate gradients need about as many steps, but each waits for sums over the picture. Here a step of a
//! row needs only the previous step of two more rows. While a pass moves down the picture, each step follows two rows
//! behind the previous one, and the coefficients, which dominate the memory, are fetched from distant caches once per
//! pass. Steps are limited by loads: coefficients are loaded once for two planes, and values once for two rows.

use std::iter::zip;
use std::ops::Range;

use imaging::{Plane, vectorized};

use super::tile::{BLOCK, ChebyshevStep, SPAN, TileCoefficients, take_tile};
use super::windows::{RIM, STEPS, each_row};

/// Maximum number of windows that contain a pixel.
const WINDOWS: f64 = 9.0;
/// Rows that a step of a pass advances together: even.
const ROWS: usize = 8;
/// Steps of a pass. More would read more rows than fit the nearest caches.
const PASS: usize = 12;
/// `A`. Columns and rows are whole tiles, with a rim of zeros: outside of the picture zeros stay zeros.
pub(super) struct System {
    width: usize,
    height: usize,
    closeness: f64,
    tiles: usize,
    /// The tiles of each row, including the rim; λ is on the diagonal.
    coefficients: Vec<TileCoefficients>,
}

impl System {
    /// The system of a picture of at least 3 × 3 pixels.
    pub(super) fn new(channels: &[Plane<u8>; 3], closeness: f64) -> Self {
        let (width, height) = channels[0].size();
        let tiles = width.div_ceil(BLOCK);
        let rows = height.next_multiple_of(2) + 2 * RIM;
        let mut coefficients = vec![[[0.0; SPAN]; STEPS.len()]; tiles * rows];
        each_row::<f32>(channels, |y, row| {
            let records = &mut coefficients[(y + RIM) * tiles..][..tiles];
            for (tile, record) in records.iter_mut().enumerate() {
                for (number, (to, values)) in zip(record, row).enumerate() {
                    let own = if number == 0 { closeness as f32 } else { 0.0 };
                    let values = &values[tile * BLOCK..];
                    zip(to, values).for_each(|(to, value)| *to = value + own);
                }
            }
        });
        Self {
            width,
            height,
            closeness,
            tiles,
            coefficients,
        }
    }

    /// Solves `A x = λ p` for several planes together, to a residual of `residual` times `λ p`, apart from rounding.
    pub(super) fn solved<const N: usize>(&self, planes: [&Plane<f64>; N], residual: f64) -> [Plane<f64>; N] {
        // Constants are preserved, so only the difference from the mean needs precision.
        let means = planes.map(|plane| plane.data().iter().sum::<f64>() / plane.data().len() as f64);
        let b = std::array::from_fn(|n| self.loaded(planes[n], means[n]));
        let x: [Vec<f32>; N] = std::array::from_fn(|n| vec![0.0; Vec::len(&b[n])]);
        let mut x = [x.clone(), x];
        for steps in steps(self.closeness, residual).chunks(PASS) {
            self.pass(&b, &mut x, steps);
            // Steps write to the planes alternately, starting with `x[0]`; the last must write `x[1]`.
            if steps.len() % 2 == 1 {
                x.swap(0, 1);
            }
        }
        std::array::from_fn(|n| {
            Plane::from_fn(self.width, self.height, |column, y| {
                means[n] + f64::from(x[1][n][self.start_of(y) + column])
            })
        })
    }

    /// `λ (p - mean)`, with the rim.
    fn loaded(&self, plane: &Plane<f64>, mean: f64) -> Vec<f32> {
        let mut loaded = vec![0.0; self.stride() * (self.height.next_multiple_of(2) + 2 * RIM)];
        for (y, values) in plane.data().chunks_exact(self.width).enumerate() {
            let row = zip(&mut loaded[self.start_of(y)..], values);
            row.for_each(|(to, value)| *to = (self.closeness * (value - mean)) as f32);
        }
        loaded
    }

    /// Runs consecutive steps from the first row to the last. `planes` are `x_{k-1}` and `x_k`; after an odd number of
    /// steps they are in the other order.
    fn pass<const N: usize>(
        &self,
        b: &[Vec<f32>; N],
        planes: &mut [[Vec<f32>; N]; 2],
        steps: &[ChebyshevStep],
    ) {
        let height = self.height.next_multiple_of(2);
        for front in (0..height + RIM * (steps.len() - 1)).step_by(ROWS) {
            for (level, step) in steps.iter().enumerate() {
                let lag = RIM * level;
                let rows = front.saturating_sub(lag)..(front + ROWS).saturating_sub(lag).min(height);
                let [before, now] = &mut *planes;
                // The overwritten rows are two steps old and no longer needed.
                if level.is_multiple_of(2) {
                    vectorized!(self.take_rows(*step, rows.clone(), b, now, before));
                } else {
                    vectorized!(self.take_rows(*step, rows.clone(), b, before, now));
                }
            }
        }
    }

    /// Writes an even number of rows of `x_{k+1}` over those of `x_{k-1}`.
    #[inline(always)]
    fn take_rows<const N: usize>(
        &self,
        step: ChebyshevStep,
        rows: Range<usize>,
        b: &[Vec<f32>; N],
        now: &[Vec<f32>; N],
        to: &mut [Vec<f32>; N],
    ) {
        for y in rows.step_by(2) {
            for tile in 0..self.tiles {
                // From two rows before the tile to its second row.
                let records: [&TileCoefficients; 4] =
                    std::array::from_fn(|row| &self.coefficients[(y + row) * self.tiles + tile]);
                take_tile(
                    step,
                    records,
                    (self.start_of(y) + tile * BLOCK, self.stride()),
                    b,
                    now,
                    to,
                );
            }
        }
    }

    /// Start of a row of pixels in a plane with its rim.
    fn start_of(&self, y: usize) -> usize {
        (y + RIM) * self.stride() + RIM
    }

    /// Columns of a plane with its rim.
    fn stride(&self) -> usize {
        self.tiles * BLOCK + 2 * RIM
    }
}

/// The steps from `x_0 = x_{-1}` to a share of the residual.
fn steps(closeness: f64, residual: f64) -> Vec<ChebyshevStep> {
    let half = WINDOWS / 2.0;
    let sigma = (closeness + half) / half;
    let count = ((1.0 / residual).acosh() / sigma.acosh()).ceil() as usize;
    let first = ChebyshevStep {
        momentum: 0.0,
        length: (1.0 / (closeness + half)) as f32,
    };
    let mut rho = 1.0 / sigma;
    let later = (1..count.max(1)).map(|_| {
        let next = 1.0 / (2.0 * sigma - rho);
        let step = ChebyshevStep {
            momentum: (next * rho) as f32,
            length: (2.0 * next / half) as f32,
        };
        rho = next;
        step
    });
    std::iter::once(first).chain(later).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_of_steps_follows_from_the_residual() {
        assert_eq!(steps(1e-2, 1e-3).len(), 115);
        assert_eq!(steps(1e-2, 1.0).len(), 1);
    }
}
