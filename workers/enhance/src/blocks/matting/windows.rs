//! The coefficients of the matting Laplacian, row by row.

use std::iter::zip;
use std::ops::{Add, AddAssign, Mul};

use imaging::{Plane, vectorized};

/// Width of the rim of zeros around the picture: the reach of a coefficient.
pub(super) const RIM: usize = 2;
/// Offsets from a pixel to itself and to the later ones of its neighborhood: columns and rows.
pub(super) const STEPS: [(isize, usize); 13] = [
    (0, 0),
    (1, 0),
    (2, 0),
    (-2, 1),
    (-1, 1),
    (0, 1),
    (1, 1),
    (2, 1),
    (-2, 2),
    (-1, 2),
    (0, 2),
    (1, 2),
    (2, 2),
];

/// Added to the diagonal of each window's covariance, for colors in 0..=255.
const RIDGE: f64 = 1e-7 / 9.0 * 255.0 * 255.0;
/// Windows per block: their whitened colors fit the first-level cache.
const BLOCK: usize = 64;
/// Windows whose sums stay in registers; a block is several groups.
const GROUP: usize = 16;
/// Pixels of a window, and its side.
const PIXELS: usize = 9;
const SIDE: usize = 3;

type WindowLanes<T> = [T; BLOCK];

/// A row of each of [`STEPS`], with its rim.
pub(super) type StepRows<T> = [Vec<T>; STEPS.len()];

/// Number type of the coefficient sums. Products of whitened colors are at most 9: f32 is enough for a system in f32.
pub(super) trait WindowNumber: Copy + Add<Output = Self> + AddAssign + Mul<Output = Self> {
    fn from_f64(value: f64) -> Self;
}

impl WindowNumber for f32 {
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value as Self
    }
}

impl WindowNumber for f64 {
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value
    }
}

/// Calls `take` with the rows of a picture of at least 3 × 3 pixels, in order, summed over its windows.
pub(super) fn each_row<T: WindowNumber>(
    channels: &[Plane<u8>; 3],
    mut take: impl FnMut(usize, &StepRows<T>),
) {
    let (width, height) = channels[0].size();
    let zero = T::from_f64(0.0);
    // Windows span three rows: a row is complete after the windows that end in it.
    let mut rows: [StepRows<T>; SIDE] =
        std::array::from_fn(|_| std::array::from_fn(|_| vec![zero; width + 2 * RIM]));
    let mut white = Box::new([[[zero; BLOCK]; 3]; PIXELS]);
    for y in 0..height {
        if y + SIDE <= height {
            for x in (0..width + 1 - SIDE).step_by(BLOCK) {
                let count = BLOCK.min(width + 1 - SIDE - x);
                let lines = channels
                    .each_ref()
                    .map(|plane| std::array::from_fn(|row| &plane.row(y + row)[x..x + count + SIDE - 1]));
                vectorized!(whiten(&lines, count, &mut white));
                vectorized!(add(&white, (x, count), &mut rows));
            }
        }
        take(y, &rows[0]);
        rows.rotate_left(1);
        rows[SIDE - 1].iter_mut().for_each(|row| row.fill(zero));
    }
}

/// Whitened colors of each window: the difference from the mean times `C⁻¹`, with `C Cᵀ` the covariance. Their products
/// equal those with the inverse covariance. For colors on a line the adjugate would lose the ridge to rounding, and the
/// matrix would not stay positive.
#[inline(always)]
fn whiten<T: WindowNumber>(
    lines: &[[&[u8]; SIDE]; 3],
    count: usize,
    white: &mut [[WindowLanes<T>; 3]; PIXELS],
) {
    for start in (0..count).step_by(GROUP) {
        let group = start..(start + GROUP).min(count);
        let mut codes = [[[0i32; GROUP]; PIXELS]; 3];
        for (channel, codes) in codes.iter_mut().enumerate() {
            for (pixel, codes) in codes.iter_mut().enumerate() {
                let line = &lines[channel][pixel / SIDE][pixel % SIDE..][group.clone()];
                zip(codes, line).for_each(|(to, &code)| *to = i32::from(code));
            }
        }
        whiten_group(&codes, start, white);
    }
}

#[inline(always)]
fn whiten_group<T: WindowNumber>(
    codes: &[[[i32; GROUP]; PIXELS]; 3],
    start: usize,
    white: &mut [[WindowLanes<T>; 3]; PIXELS],
) {
    let (mut sums, mut products) = ([[0i32; GROUP]; 3], [[[0i32; GROUP]; 3]; 3]);
    for pixel in 0..PIXELS {
        for a in 0..3 {
            for n in 0..GROUP {
                sums[a][n] += codes[a][pixel][n];
            }
            for b in 0..=a {
                for n in 0..GROUP {
                    products[a][b][n] += codes[a][pixel][n] * codes[b][pixel][n];
                }
            }
        }
    }
    let mut factors = [[0.0f64; GROUP]; 6];
    for n in 0..GROUP {
        let covariance = |a: usize, b: usize| {
            let ridge = if a == b { RIDGE } else { 0.0 };
            f64::from(9 * products[a][b][n] - sums[a][n] * sums[b][n]) / 81.0 + ridge
        };
        let c11 = covariance(0, 0).sqrt();
        let (c21, c31) = (covariance(1, 0) / c11, covariance(2, 0) / c11);
        let c22 = (covariance(1, 1) - c21 * c21).sqrt();
        let c32 = (covariance(2, 1) - c31 * c21) / c22;
        let c33 = (covariance(2, 2) - c31 * c31 - c32 * c32).sqrt();
        for (factor, value) in zip(&mut factors, [1.0 / c11, c21, 1.0 / c22, c31, c32, 1.0 / c33]) {
            factor[n] = value;
        }
    }
    let [i11, c21, i22, c31, c32, i33] = &factors;
    for (pixel, white) in white.iter_mut().enumerate() {
        let [red, green, blue] = white.each_mut().map(|lanes| &mut lanes[start..start + GROUP]);
        for n in 0..GROUP {
            // Nine times the distance from the mean is exact.
            let away = |c: usize| f64::from(9 * codes[c][pixel][n] - sums[c][n]) / 9.0;
            let r = away(0) * i11[n];
            let g = (away(1) - c21[n] * r) * i22[n];
            red[n] = T::from_f64(r);
            green[n] = T::from_f64(g);
            blue[n] = T::from_f64((away(2) - c31[n] * r - c32[n] * g) * i33[n]);
        }
    }
}

/// Adds the windows from column `x` on. Each coefficient sums its windows from left to right, for any block size.
#[inline(always)]
fn add<T: WindowNumber>(
    white: &[[WindowLanes<T>; 3]; PIXELS],
    (x, count): (usize, usize),
    rows: &mut [StepRows<T>; SIDE],
) {
    let share = T::from_f64(-1.0 / 9.0);
    for row in 0..SIDE {
        for column in (0..SIDE).rev() {
            let i = SIDE * row + column;
            for j in i..PIXELS {
                let step = step_of((j % SIDE) as isize - column as isize, j / SIDE - row);
                let target = &mut rows[row][step][x + column + RIM..][..count];
                let own = T::from_f64(if i == j { 8.0 / 9.0 } else { -1.0 / 9.0 });
                let ([a, b, c], [d, e, f]) = (&white[i], &white[j]);
                for n in 0..count {
                    target[n] += own + share * (a[n] * d[n] + b[n] * e[n] + c[n] * f[n]);
                }
            }
        }
    }
}

fn step_of(columns: isize, rows: usize) -> usize {
    // The pixel's row has no steps to the left.
    let first = if rows == 0 { 0 } else { 5 * rows };
    first.wrapping_add_signed(columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_stand_in_their_order() {
        for (place, (columns, rows)) in STEPS.into_iter().enumerate() {
            assert_eq!(step_of(columns, rows), place);
        }
    }
}
