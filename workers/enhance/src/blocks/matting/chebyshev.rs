//! Large pictures: the iteration of Chebyshev (Golub and Varga 1961; Saad 2003, algorithm 12.1) in f32, several steps in one pass.
//!
//! Each window adds to L a matrix whose eigenvalues lie in 0..=1, and a pixel is in nine windows at most, so those of `A = L + λ E` lie in
//! λ..=λ + 9, whatever the picture. So the steps
//!
//! ```text
//! x_{k+1} = x_k + ρ_k ρ_{k-1} (x_k - x_{k-1}) + 2 ρ_k/δ (b - A x_k)      ρ_k = 1/(2 σ - ρ_{k-1}),  ρ_0 = 1/σ
//! ```
//!
//! with `δ = 9/2`, `σ = (λ + δ)/δ` are known beforehand, and how many leave which share of the residual: `1/cosh(k acosh σ)`. Conjugate
//! gradients need about as many, but each waits for sums over the picture. Here a step of one row needs the last step of two rows more
//! and no other, so that while a pass goes down the picture once, each step follows two rows behind the one before: what they
//! read stays in the second-level cache, and the coefficients, which are most of the memory, come from farther away once in a pass.

use std::iter::zip;
use std::ops::Range;

use imaging::{Plane, vectorized};

use super::windows::{RIM, STEPS, each_row};

/// Windows that a pixel is in, at most.
const WINDOWS: f64 = 9.0;
/// Steps of a pass. More would read more rows than the second-level cache holds.
const PASS: usize = 8;
/// Coefficients of a row: its diagonal, and to the neighbors after and before it.
const NEIGHBORS: usize = 2 * STEPS.len() - 1;
/// Pixels whose sums stay in registers, and fewer at the end of a row.
const BLOCK: usize = 64;
const SMALL_BLOCK: usize = 8;

/// `A`. Planes have a rim of zeros.
pub(super) struct System {
    width: usize,
    height: usize,
    closeness: f64,
    /// Of each of [`STEPS`]; λ is on the diagonal.
    coefficients: [Vec<f32>; STEPS.len()],
}

/// `x_{k+1} = x_k + momentum (x_k - x_{k-1}) + length (b - A x_k)`.
#[derive(Clone, Copy)]
struct Step {
    momentum: f32,
    length: f32,
}

impl System {
    /// Of a picture of at least 3 × 3 pixels.
    pub(super) fn new(channels: &[Plane<u8>; 3], closeness: f64) -> Self {
        let (width, height) = channels[0].size();
        let mut system = Self {
            width,
            height,
            closeness,
            coefficients: std::array::from_fn(|_| vec![0.0; (width + 2 * RIM) * (height + 2 * RIM)]),
        };
        each_row(channels, |y, rows| {
            let row = system.row(y);
            for (plane, values) in zip(&mut system.coefficients, rows) {
                zip(&mut plane[row.clone()], &values[RIM..]).for_each(|(to, &value)| *to = value as f32);
            }
            let diagonal = zip(&mut system.coefficients[0][row], &rows[0][RIM..]);
            diagonal.for_each(|(to, own)| *to = (own + closeness) as f32);
        });
        system
    }

    /// `x` of `A x = λ p`: the residual is `residual` of `λ p` at most, but for rounding.
    pub(super) fn solved(&self, plane: &Plane<f64>, residual: f64) -> Plane<f64> {
        // A constant comes back, so that only what differs from the mean needs digits.
        let mean = plane.data().iter().sum::<f64>() / plane.data().len() as f64;
        let mut b = vec![0.0f32; self.coefficients[0].len()];
        for (y, values) in plane.data().chunks_exact(self.width).enumerate() {
            let row = zip(&mut b[self.row(y)], values);
            row.for_each(|(to, value)| *to = (self.closeness * (value - mean)) as f32);
        }
        let steps = steps(self.closeness, residual);
        let mut planes = [(); 2].map(|()| vec![0.0f32; b.len()]);
        for steps in steps.chunks(PASS) {
            self.pass(&b, &mut planes, steps);
            // Steps write the planes in turn, the first one `planes[0]`: the newest is to be `planes[1]`.
            if steps.len() % 2 == 1 {
                planes.swap(0, 1);
            }
        }
        Plane::from_fn(self.width, self.height, |x, y| {
            mean + f64::from(planes[1][self.row(y).start + x])
        })
    }

    /// Takes steps that follow each other, in rows from the first to the last. `planes` are `x_{k-1}` and `x_k`; an odd number of
    /// steps leaves them in the other order.
    fn pass(&self, b: &[f32], planes: &mut [Vec<f32>; 2], steps: &[Step]) {
        let lag = |level: usize| RIM * level;
        for front in 0..self.height + lag(steps.len() - 1) {
            for (level, step) in steps.iter().enumerate() {
                let Some(y) = front.checked_sub(lag(level)).filter(|&y| y < self.height) else {
                    continue;
                };
                let [before, now] = &mut *planes;
                // What is written is two steps old, and no other row needs it any more.
                if level.is_multiple_of(2) {
                    self.step(*step, y, b, now, before);
                } else {
                    self.step(*step, y, b, before, now);
                }
            }
        }
    }

    /// Writes a row of `x_{k+1}` over that of `x_{k-1}`.
    fn step(&self, step: Step, y: usize, b: &[f32], now: &[f32], to: &mut [f32]) {
        let row = self.row(y);
        let neighbors: [[&[f32]; 2]; NEIGHBORS] = std::array::from_fn(|neighbor| {
            let coefficients = &self.coefficients[neighbor.div_ceil(2)];
            let reach = self.reach(neighbor.div_ceil(2));
            if neighbor.is_multiple_of(2) {
                [
                    &coefficients[row.clone()],
                    &now[row.start + reach..row.end + reach],
                ]
            } else {
                let before = row.start - reach..row.end - reach;
                [&coefficients[before.clone()], &now[before]]
            }
        });
        let (b, now, to) = (&b[row.clone()], &now[row.clone()], &mut to[row]);
        vectorized!(take_step(step, &neighbors, [b, now], to));
    }

    /// Where a row of pixels is in a plane with its rim.
    fn row(&self, y: usize) -> Range<usize> {
        let start = (y + RIM) * (self.width + 2 * RIM) + RIM;
        start..start + self.width
    }

    /// How far one of [`STEPS`] leads in a plane with its rim.
    fn reach(&self, step: usize) -> usize {
        let (columns, rows) = STEPS[step];
        (rows * (self.width + 2 * RIM)).wrapping_add_signed(columns)
    }
}

/// The steps from `x_0 = x_{-1} = 0` that leave a share of the residual.
fn steps(closeness: f64, residual: f64) -> Vec<Step> {
    let half = WINDOWS / 2.0;
    let sigma = (closeness + half) / half;
    let count = ((1.0 / residual).acosh() / sigma.acosh()).ceil() as usize;
    let first = Step {
        momentum: 0.0,
        length: (1.0 / (closeness + half)) as f32,
    };
    let mut rho = 1.0 / sigma;
    let later = (1..count.max(1)).map(|_| {
        let next = 1.0 / (2.0 * sigma - rho);
        let step = Step {
            momentum: (next * rho) as f32,
            length: (2.0 * next / half) as f32,
        };
        rho = next;
        step
    });
    std::iter::once(first).chain(later).collect()
}

#[inline(always)]
fn take_step(step: Step, neighbors: &[[&[f32]; 2]; NEIGHBORS], [b, now]: [&[f32]; 2], to: &mut [f32]) {
    let mut at = 0;
    while at + BLOCK <= to.len() {
        take_block::<BLOCK>(step, neighbors, [b, now], at, to);
        at += BLOCK;
    }
    while at + SMALL_BLOCK <= to.len() {
        take_block::<SMALL_BLOCK>(step, neighbors, [b, now], at, to);
        at += SMALL_BLOCK;
    }
    while at < to.len() {
        take_block::<1>(step, neighbors, [b, now], at, to);
        at += 1;
    }
}

#[inline(always)]
fn take_block<const COUNT: usize>(
    Step { momentum, length }: Step,
    neighbors: &[[&[f32]; 2]; NEIGHBORS],
    [b, now]: [&[f32]; 2],
    start: usize,
    to: &mut [f32],
) {
    let block = start..start + COUNT;
    let mut rest = [0.0f32; COUNT];
    rest.copy_from_slice(&b[block.clone()]);
    for [coefficients, values] in neighbors {
        let (coefficients, values) = (&coefficients[block.clone()], &values[block.clone()]);
        for i in 0..COUNT {
            rest[i] = (-coefficients[i]).mul_add(values[i], rest[i]);
        }
    }
    let (now, to) = (&now[block.clone()], &mut to[block]);
    for i in 0..COUNT {
        to[i] = length.mul_add(rest[i], momentum.mul_add(now[i] - to[i], now[i]));
    }
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
