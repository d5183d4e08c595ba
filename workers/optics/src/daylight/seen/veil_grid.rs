//! Grids of lines of sight between which the occlusion of the veil is interpolated.

use imaging::Plane;

use super::SQUARE;

/// The largest stride, and the least number of lines of sight across a picture that limits it.
const MOST_STRIDE: usize = 16;
const LEAST_ACROSS: usize = 30;
/// Each finer grid divides the stride by this.
const FINER: usize = 4;
/// A line of sight is interpolated between those whose share of lost light `1 − e^{−c z}` differs less, so that their shadow rays
/// begin at similar points.
const SIMILAR: f32 = 0.1;
/// Limit of the difference of interpolated values; a larger one indicates a shadow edge.
const SMOOTH: f32 = 0.1;

/// Every n-th pixel of every n-th row, and the last of both.
pub(super) struct Grid {
    stride: usize,
    columns: Vec<usize>,
    rows: Vec<usize>,
}

impl Grid {
    pub(super) fn coarsest((width, height): (usize, usize)) -> Self {
        let stride = (width.min(height) / LEAST_ACROSS).clamp(1, MOST_STRIDE);
        Self::new(stride, (width, height))
    }

    fn new(stride: usize, (width, height): (usize, usize)) -> Self {
        let [columns, rows] = [width, height].map(|count| {
            let last = count.saturating_sub(1);
            (0..last).step_by(stride).chain([last]).collect()
        });
        Self {
            stride,
            columns,
            rows,
        }
    }

    /// The next finer grid; `None` if this one has every pixel.
    pub(super) fn finer(&self) -> Option<Self> {
        let last = |knots: &[usize]| knots.last().map_or(0, |last| last + 1);
        let size = (last(&self.columns), last(&self.rows));
        (self.stride > 1).then(|| Self::new((self.stride / FINER).max(1), size))
    }

    /// The pixels of this grid around those without a value yet, neighbors near each other.
    pub(super) fn needed(&self, access: &Plane<f32>) -> Vec<[usize; 2]> {
        let mut is_needed = Plane::filled(self.columns.len(), self.rows.len(), false);
        for y in 0..access.height() {
            for x in (0..access.width()).filter(|&x| access.pixel(x, y).is_nan()) {
                for corner in self.corners([x, y]) {
                    is_needed.row_mut(corner.row)[corner.column] |= corner.weight > 0.0;
                }
            }
        }
        let knots = (0..self.rows.len()).flat_map(|j| (0..self.columns.len()).map(move |i| [i, j]));
        let mut knots: Vec<[usize; 2]> = knots.filter(|&[i, j]| is_needed.pixel(i, j)).collect();
        knots.sort_by_key(|&[i, j]| (j / SQUARE, i / SQUARE));
        knots
            .iter()
            .map(|&[i, j]| [self.columns[i], self.rows[j]])
            .collect()
    }

    /// Sets every pixel without a value that has similar pixels of this grid around it, by interpolating their values.
    pub(super) fn interpolate(
        &self,
        pixels: &[[usize; 2]],
        values: &[f32],
        lost: &Plane<f32>,
        access: &mut Plane<f32>,
    ) {
        let mut knots = Plane::filled(self.columns.len(), self.rows.len(), f32::NAN);
        for (&[x, y], &value) in pixels.iter().zip(values) {
            knots.row_mut(y.div_ceil(self.stride))[x.div_ceil(self.stride)] = value;
        }
        for y in 0..access.height() {
            for x in 0..access.width() {
                if !access.pixel(x, y).is_nan() {
                    continue;
                }
                if let Some(value) = self.value([x, y], &knots, lost) {
                    access.row_mut(y)[x] = value;
                }
            }
        }
    }

    /// The value of a pixel; `None` if no pixel of the grid around it is similar, or these differ.
    fn value(&self, [x, y]: [usize; 2], knots: &Plane<f32>, lost: &Plane<f32>) -> Option<f32> {
        let own = lost.pixel(x, y);
        let (mut sum, mut weight) = (0.0, 0.0);
        let (mut least, mut most) = (f32::INFINITY, f32::NEG_INFINITY);
        for corner in self.corners([x, y]) {
            let other = lost.pixel(self.columns[corner.column], self.rows[corner.row]);
            if corner.weight > 0.0 && (own - other).abs() < SIMILAR {
                let value = knots.pixel(corner.column, corner.row);
                sum += corner.weight * value;
                weight += corner.weight;
                (least, most) = (least.min(value), most.max(value));
            }
        }
        (weight > 0.0 && most - least <= SMOOTH).then(|| sum / weight)
    }

    fn corners(&self, [x, y]: [usize; 2]) -> [Corner; 4] {
        let [(left, right, s), (above, below, t)] =
            [self.between(&self.columns, x), self.between(&self.rows, y)];
        [
            (left, above, (1.0 - s) * (1.0 - t)),
            (right, above, s * (1.0 - t)),
            (left, below, (1.0 - s) * t),
            (right, below, s * t),
        ]
        .map(|(column, row, weight)| Corner { column, row, weight })
    }

    /// The knots around a coordinate, and its distance to the first as a share of theirs.
    fn between(&self, knots: &[usize], at: usize) -> (usize, usize, f32) {
        let low = (at / self.stride).min(knots.len() - 1);
        let high = (low + 1).min(knots.len() - 1);
        let step = (knots[high] - knots[low]).max(1);
        (low, high, (at - knots[low]) as f32 / step as f32)
    }
}

/// A pixel of the grid next to another pixel.
struct Corner {
    column: usize,
    row: usize,
    weight: f32,
}
