//! Running sums over square windows that are clipped to the picture: a constant number of additions per pixel.

use std::ops::Range;

/// The positions of `0..n` within `radius` of `i`.
pub(super) fn inside(i: usize, radius: usize, n: usize) -> Range<usize> {
    i.saturating_sub(radius)..(i + radius + 1).min(n)
}

/// Reciprocal number of positions in each window of `0..n`.
pub(super) fn inverse_counts(n: usize, radius: usize) -> Vec<f64> {
    (0..n).map(|i| 1.0 / inside(i, radius, n).len() as f64).collect()
}

/// Sums of K quantities over the windows of one row.
pub(super) struct WindowSums<const K: usize> {
    radius: usize,
    width: usize,
    /// For each quantity and column, the sum down the rows of the window, maintained by the caller.
    pub(super) columns: [Vec<f64>; K],
    /// Running totals along `columns`: entry j is the sum of the first `clamp(j - radius, 0, width)` columns.
    totals: [Vec<f64>; K],
}

impl<const K: usize> WindowSums<K> {
    pub(super) fn new(width: usize, radius: usize) -> Self {
        Self {
            radius,
            width,
            columns: std::array::from_fn(|_| vec![0.0; width]),
            totals: std::array::from_fn(|_| vec![0.0; width + 2 * radius + 1]),
        }
    }

    /// Recomputes the totals after changes to the columns.
    #[inline(always)]
    pub(super) fn total(&mut self) {
        let (radius, width) = (self.radius, self.width);
        let (quads, rest) = self.totals.as_chunks_mut::<4>();
        let (quad_columns, rest_columns) = self.columns.as_chunks::<4>();
        // Four sums at a time: a single one would wait for its previous addition.
        for (totals, columns) in quads.iter_mut().zip(quad_columns) {
            let [a, b, c, d] = totals.each_mut().map(|totals| &mut totals[radius + 1..]);
            let [from_a, from_b, from_c, from_d] = columns.each_ref().map(Vec::as_slice);
            let mut sums = [0.0f64; 4];
            let columns = from_a.iter().zip(from_b).zip(from_c.iter().zip(from_d));
            let totals = a.iter_mut().zip(b.iter_mut()).zip(c.iter_mut().zip(d.iter_mut()));
            for (((a, b), (c, d)), ((va, vb), (vc, vd))) in totals.zip(columns) {
                sums = [sums[0] + va, sums[1] + vb, sums[2] + vc, sums[3] + vd];
                [*a, *b, *c, *d] = sums;
            }
            for (totals, sum) in [a, b, c, d].into_iter().zip(sums) {
                totals[width..].fill(sum);
            }
        }
        for (totals, column) in rest.iter_mut().zip(rest_columns) {
            let totals = &mut totals[radius + 1..];
            let mut sum = 0.0;
            for (total, column) in totals.iter_mut().zip(column) {
                sum += column;
                *total = sum;
            }
            totals[width..].fill(sum);
        }
    }

    /// Totals at the start and the end of every window: their difference is the window's sum.
    #[inline(always)]
    pub(super) fn windows(&self, quantity: usize) -> (&[f64], &[f64]) {
        let totals = &self.totals[quantity];
        (&totals[..self.width], &totals[2 * self.radius + 1..])
    }
}

/// Adds an entering row to the columns and subtracts a leaving one.
#[inline(always)]
pub(super) fn exchange(columns: &mut [f64], enters: &[f64], leaves: &[f64]) {
    for ((column, enters), leaves) in columns.iter_mut().zip(enters).zip(leaves) {
        *column += enters - leaves;
    }
}
