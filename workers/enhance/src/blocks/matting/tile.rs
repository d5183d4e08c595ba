//! One step of the iteration on a tile: two rows of a few columns.

use super::windows::{RIM, STEPS};

/// Columns of a tile: its sums stay in registers.
pub(super) const BLOCK: usize = 32;
/// Columns of coefficients and values read by a tile.
pub(super) const SPAN: usize = BLOCK + 2 * RIM;
/// Rows and columns within the reach of coefficients.
const SIDE: usize = 2 * RIM + 1;

/// TileCoefficients of a row of a tile for all [`STEPS`]: one contiguous stream of memory.
pub(super) type TileCoefficients = [[f32; SPAN]; STEPS.len()];

/// `x_{k+1} = x_k + momentum (x_k - x_{k-1}) + length (b - A x_k)`.
#[derive(Clone, Copy)]
pub(super) struct ChebyshevStep {
    pub(super) momentum: f32,
    pub(super) length: f32,
}

/// Writes a tile of `x_{k+1}` over `x_{k-1}`, of one plane or of two. `records` are the coefficients of the two rows
/// before the tile and of its rows; `start` is its first pixel in planes of `stride` columns.
#[inline(always)]
pub(super) fn take_tile<const N: usize>(
    step: ChebyshevStep,
    records: [&TileCoefficients; 4],
    (start, stride): (usize, usize),
    b: &[Vec<f32>; N],
    now: &[Vec<f32>; N],
    to: &mut [Vec<f32>; N],
) {
    const { assert!(N == 1 || N == 2, "one plane or two") };
    let [first, last] = [0, N - 1];
    let second = start + stride;
    // Separate variables: indexed arrays would not stay in registers.
    let (mut upper, mut lower) = (block(&b[first], start), block(&b[first], second));
    let (mut upper_last, mut lower_last) = (block(&b[last], start), block(&b[last], second));
    for row in 0..=SIDE {
        let origin = start + row * stride - RIM * stride - RIM;
        let (values, values_last) = (&now[first][origin..][..SPAN], &now[last][origin..][..SPAN]);
        for column in 0..SIDE {
            if row < SIDE {
                let reach = coefficient([records[0], records[1], records[2]], column, row);
                subtract(&mut upper, reach, values, column);
                if N == 2 {
                    subtract(&mut upper_last, reach, values_last, column);
                }
            }
            if row > 0 {
                let reach = coefficient([records[1], records[2], records[3]], column, row - 1);
                subtract(&mut lower, reach, values, column);
                if N == 2 {
                    subtract(&mut lower_last, reach, values_last, column);
                }
            }
        }
    }
    finish(step, &upper, &now[first][start..], &mut to[first][start..]);
    finish(step, &lower, &now[first][second..], &mut to[first][second..]);
    if N == 2 {
        finish(step, &upper_last, &now[last][start..], &mut to[last][start..]);
        finish(step, &lower_last, &now[last][second..], &mut to[last][second..]);
    }
}

#[inline(always)]
fn block(plane: &[f32], start: usize) -> [f32; BLOCK] {
    let mut block = [0.0; BLOCK];
    block.copy_from_slice(&plane[start..start + BLOCK]);
    block
}

/// TileCoefficients from a row to the pixels at a column and row of the neighborhood, both counted from its corner.
/// `records` are those of the two previous rows and of the row.
#[inline(always)]
fn coefficient(records: [&TileCoefficients; 3], column: usize, row: usize) -> &[f32] {
    let number = (SIDE * row + column).abs_diff(SIDE * RIM + RIM);
    let [record, at] = if (row, column) >= (RIM, RIM) {
        [RIM, RIM]
    } else {
        [row, column]
    };
    &records[record][number][at..at + BLOCK]
}

#[inline(always)]
fn subtract(rest: &mut [f32; BLOCK], coefficients: &[f32], values: &[f32], column: usize) {
    let (coefficients, values) = (&coefficients[..BLOCK], &values[column..column + BLOCK]);
    for i in 0..BLOCK {
        rest[i] = (-coefficients[i]).mul_add(values[i], rest[i]);
    }
}

#[inline(always)]
fn finish(
    ChebyshevStep { momentum, length }: ChebyshevStep,
    rest: &[f32; BLOCK],
    now: &[f32],
    to: &mut [f32],
) {
    let (now, to) = (&now[..BLOCK], &mut to[..BLOCK]);
    for i in 0..BLOCK {
        to[i] = length.mul_add(rest[i], momentum.mul_add(now[i] - to[i], now[i]));
    }
}
