//! One sweep down the picture with running sums. The coefficients of a row are added to the sums for their means
//! immediately, and a ring of rows stores the values to subtract later: only the result is as large as the picture. All
//! sums are f64, since the background light is a search among nearly equal distances.

use imaging::{Plane, vectorized};

use super::guide::{Guide, solve};
use crate::blocks::sums::{WindowSums, exchange, inverse_counts};

/// Columns whose sums stay in the nearest cache.
const BLOCK: usize = 32;
/// Guide, its products, the plane, and its products with the guide.
const MOMENTS: usize = 13;
/// Slopes for the three codes, and the offset.
const COEFFICIENTS: usize = 4;
/// Pairs of channels, in the order of the matrix.
const PAIRS: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

pub(super) fn guided(guide: &Guide, plane: &Plane<f64>) -> Plane<f64> {
    vectorized!(sweep(guide, plane))
}

/// One row of the guide and of the plane.
#[derive(Clone, Copy)]
struct GuideRow<'a> {
    codes: [&'a [u8]; 3],
    plane: &'a [f64],
}

#[inline(always)]
fn sweep(guide: &Guide, plane: &Plane<f64>) -> Plane<f64> {
    let (width, height) = plane.size();
    let radius = guide.radius_px;
    let (across, down) = (inverse_counts(width, radius), inverse_counts(height, radius));
    let regularization = guide.regularization / (guide.scale * guide.scale);
    let (no_codes, no_plane) = (vec![0u8; width], vec![0.0; width]);
    let none = GuideRow {
        codes: [&no_codes; 3],
        plane: &no_plane,
    };
    let row = |y: usize| GuideRow {
        codes: guide.channels.each_ref().map(|channel| channel.row(y)),
        plane: plane.row(y),
    };
    let mut moments = WindowSums::<MOMENTS>::new(width, radius);
    let mut coefficients = WindowSums::<COEFFICIENTS>::new(width, radius);
    let mut ring = vec![[0; COEFFICIENTS].map(|_| vec![0.0; width]); 2 * radius + 1];
    let mut found = [0; COEFFICIENTS].map(|_| vec![0.0; width]);
    let mut filtered = Plane::filled(width, height, 0.0);
    for y in 0..radius.min(height) {
        slide(&mut moments.columns, row(y), none);
    }
    // The coefficients run ahead of the result by the radius.
    for ahead in 0..height + radius {
        if ahead < height {
            let y = ahead;
            let enters = if y + radius < height {
                row(y + radius)
            } else {
                none
            };
            let leaves = if y > radius { row(y - radius - 1) } else { none };
            slide(&mut moments.columns, enters, leaves);
            moments.total();
            coefficient_row(&moments, (&across, down[y]), regularization, &mut found);
        } else {
            found.iter_mut().for_each(|row| row.fill(0.0));
        }
        let slot = ahead % ring.len();
        let columns = coefficients.columns.iter_mut();
        for ((columns, enters), leaves) in columns.zip(&found).zip(&mut ring[slot]) {
            exchange(columns, enters, leaves);
            leaves.copy_from_slice(enters);
        }
        if let Some(y) = ahead.checked_sub(radius) {
            coefficients.total();
            apply_row(
                &coefficients,
                (&across, down[y]),
                row(y).codes,
                filtered.row_mut(y),
            );
        }
    }
    filtered
}

/// Adds the entering row to the column sums and subtracts the leaving one.
#[inline(always)]
fn slide(columns: &mut [Vec<f64>; MOMENTS], enters: GuideRow, leaves: GuideRow) {
    let (codes, rest) = columns.split_at_mut(3);
    let (products, rest) = rest.split_at_mut(6);
    let (plane, with_plane) = rest.split_at_mut(1);
    for (i, columns) in codes.iter_mut().enumerate() {
        for (column, (&new, &old)) in columns
            .iter_mut()
            .zip(enters.codes[i].iter().zip(leaves.codes[i]))
        {
            *column += f64::from(i32::from(new) - i32::from(old));
        }
    }
    for (&(i, j), columns) in PAIRS.iter().zip(products) {
        let enters = enters.codes[i].iter().zip(enters.codes[j]);
        let leaves = leaves.codes[i].iter().zip(leaves.codes[j]);
        for (column, ((&a, &b), (&c, &d))) in columns.iter_mut().zip(enters.zip(leaves)) {
            *column += f64::from(i32::from(a) * i32::from(b) - i32::from(c) * i32::from(d));
        }
    }
    exchange(&mut plane[0], enters.plane, leaves.plane);
    for (i, columns) in with_plane.iter_mut().enumerate() {
        let enters = enters.codes[i].iter().zip(enters.plane);
        let leaves = leaves.codes[i].iter().zip(leaves.plane);
        for (column, ((&a, &p), (&c, &q))) in columns.iter_mut().zip(enters.zip(leaves)) {
            *column += f64::from(a) * p - f64::from(c) * q;
        }
    }
}

/// The coefficients of the windows around one row.
#[inline(always)]
fn coefficient_row(
    moments: &WindowSums<MOMENTS>,
    (across, down): (&[f64], f64),
    regularization: f64,
    found: &mut [Vec<f64>; COEFFICIENTS],
) {
    let width = across.len();
    for start in (0..width).step_by(BLOCK) {
        let end = (start + BLOCK).min(width);
        let means = block_means(moments, across, down, start, end);
        let mut block = [[0.0f64; BLOCK]; COEFFICIENTS];
        for x in 0..BLOCK {
            let [r, g, b, rr, rg, rb, gg, gb, bb, p, rp, gp, bp] = means.each_ref().map(|means| means[x]);
            let matrix = [
                rr - r * r + regularization,
                rg - r * g,
                rb - r * b,
                gg - g * g + regularization,
                gb - g * b,
                bb - b * b + regularization,
            ];
            let slope = solve(matrix, [rp - r * p, gp - g * p, bp - b * p]);
            block[0][x] = slope[0];
            block[1][x] = slope[1];
            block[2][x] = slope[2];
            block[3][x] = p - (slope[0] * r + slope[1] * g + slope[2] * b);
        }
        for (row, block) in found.iter_mut().zip(&block) {
            row[start..end].copy_from_slice(&block[..end - start]);
        }
    }
}

/// `q = mean(a) · I + mean(b)` along one row.
#[inline(always)]
fn apply_row(
    coefficients: &WindowSums<COEFFICIENTS>,
    (across, down): (&[f64], f64),
    codes: [&[u8]; 3],
    filtered: &mut [f64],
) {
    let width = across.len();
    for start in (0..width).step_by(BLOCK) {
        let end = (start + BLOCK).min(width);
        let means = block_means(coefficients, across, down, start, end);
        let mut color = [[0.0f64; BLOCK]; 3];
        for (color, codes) in color.iter_mut().zip(codes) {
            for (value, &code) in color.iter_mut().zip(&codes[start..end]) {
                *value = f64::from(code);
            }
        }
        let mut block = [0.0f64; BLOCK];
        for x in 0..BLOCK {
            block[x] = means[0][x] * color[0][x]
                + means[1][x] * color[1][x]
                + means[2][x] * color[2][x]
                + means[3][x];
        }
        filtered[start..end].copy_from_slice(&block[..end - start]);
    }
}

/// Means over the windows of columns `start..end`; the rest of the block is 0.
#[inline(always)]
fn block_means<const K: usize>(
    sums: &WindowSums<K>,
    across: &[f64],
    down: f64,
    start: usize,
    end: usize,
) -> [[f64; BLOCK]; K] {
    let mut means = [[0.0f64; BLOCK]; K];
    for (quantity, means) in means.iter_mut().enumerate() {
        let (before, after) = sums.windows(quantity);
        let windows = before[start..end].iter().zip(&after[start..end]);
        for ((mean, (before, after)), across) in means.iter_mut().zip(windows).zip(&across[start..end]) {
            *mean = (after - before) * (across * down);
        }
    }
    means
}
