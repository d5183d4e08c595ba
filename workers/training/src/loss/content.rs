//! ContentPicture loss: windowed normalized cross-correlation of the picture before and after.
//!
//! `ncc = cov / sqrt((va + e)(vb + e))` in windows of 7×7 in steps of 2, for a before and b after; `loss = mean(w (1 -
//! ncc)) / (mean(w) + 0.05)`, `w = va / (va + 4e-4)`, so that flat windows do not count. Gain and offset of b do not
//! matter: a water may reduce contrast and lift black. With ranges q, 0 near and 1 far, w is multiplied by `(1 − q)²`
//! at the window's center: distant content may vanish. Brightness at all levels; from the second on also two color
//! differences at a quarter of the weight. Mean over levels.

use rayon::prelude::*;

use super::pyramid::{LEVELS, Pyramid};
use super::weights::CONTENT;
use crate::real::Real;
use crate::tensor::Tensor;

const WINDOW: usize = 7;
const STEP: usize = 2;
const VARIANCE_FLOOR: f64 = 1e-5;
/// Variance at which a window counts half.
const HALF_WEIGHT: f64 = 4e-4;
const MEAN_FLOOR: f64 = 0.05;

/// Color axes and their weights: brightness and two differences.
const AXES: [([f64; 3], f64); 3] = [
    ([0.299, 0.587, 0.114], 1.0),
    ([0.5, -0.5, 0.0], 0.25),
    ([0.25, 0.25, -0.5], 0.25),
];

/// The loss of a batch. Adds the weighted gradient for each picture to `gradients`.
pub(crate) fn content<T: Real>(
    before: &[Pyramid<T>],
    after: &[Pyramid<T>],
    ranges: Option<&[Pyramid<T>]>,
    gradients: &mut [Pyramid<T>],
) -> f64 {
    let pictures = before.par_iter().zip(after).enumerate();
    let windows = pictures.map(|(index, (before, after))| {
        let levels = (0..LEVELS).map(|level| {
            let range = ranges.map(|ranges| &ranges[index].levels[level]);
            compare_level(&before.levels[level], &after.levels[level], range, level)
        });
        levels.collect::<Vec<_>>()
    });
    let windows: Vec<Vec<Vec<Windows<T>>>> = windows.collect();
    let mut loss = 0.0;
    let mut factors = vec![Vec::new(); LEVELS];
    for level in 0..LEVELS {
        for axis in 0..windows[0][level].len() {
            let pictures = windows.iter().map(|picture| &picture[level][axis]);
            let count = pictures
                .clone()
                .map(|windows| windows.slopes.len())
                .sum::<usize>() as f64;
            let weight = pictures.clone().map(|windows| windows.weight).sum::<f64>();
            let lost = pictures.map(|windows| windows.lost).sum::<f64>();
            let scale = AXES[axis].1 / LEVELS as f64 / (weight / count + MEAN_FLOOR) / count;
            loss += lost * scale;
            factors[level].push(CONTENT * scale);
        }
    }
    gradients
        .par_iter_mut()
        .zip(&windows)
        .for_each(|(gradient, windows)| {
            for level in 0..LEVELS {
                for (axis, windows) in windows[level].iter().enumerate() {
                    windows.add_gradient(&mut gradient.levels[level], AXES[axis].0, factors[level][axis]);
                }
            }
        });
    loss
}

/// Projects a picture on a color axis.
fn project<T: Real>(picture: &Tensor<T>, axis: [f64; 3]) -> Tensor<T> {
    let [r, g, b] = axis.map(T::from_f64);
    let mut out = Tensor::zeros(1, picture.height, picture.width);
    let channels = picture
        .plane(0)
        .iter()
        .zip(picture.plane(1))
        .zip(picture.plane(2));
    for (out, ((&red, &green), &blue)) in out.data.iter_mut().zip(channels) {
        *out = red * r + green * g + blue * b;
    }
    out
}

/// Window sums of a plane.
struct Windows<T> {
    before: Tensor<T>,
    after: Tensor<T>,
    columns: usize,
    /// Sum of the weights.
    weight: f64,
    /// Sum of the weighted losses.
    lost: f64,
    /// For each window, the slope of `lost` for a sample b in it: `alpha a + beta b + gamma`.
    slopes: Vec<[T; 3]>,
}

impl<T: Real> Windows<T> {
    fn new(before: Tensor<T>, after: Tensor<T>, range: Option<&Tensor<T>>) -> Self {
        let (width, height) = (before.width, before.height);
        let [columns, rows] = [width, height].map(|side| (side + STEP).saturating_sub(WINDOW) / STEP);
        let mut windows = Self {
            before,
            after,
            columns,
            weight: 0.0,
            lost: 0.0,
            slopes: Vec::with_capacity(columns * rows),
        };
        let mut sums = vec![[0.0f64; 5]; width];
        for row in 0..rows {
            sums.fill([0.0; 5]);
            for y in STEP * row..STEP * row + WINDOW {
                let pairs = windows.before.row(0, y).iter().zip(windows.after.row(0, y));
                for (sums, (&a, &b)) in sums.iter_mut().zip(pairs) {
                    let (a, b) = (a.to_f64(), b.to_f64());
                    for (sum, value) in sums.iter_mut().zip([a, b, a * a, b * b, a * b]) {
                        *sum += value;
                    }
                }
            }
            for column in 0..columns {
                let mut moments = [0.0; 5];
                for sums in &sums[STEP * column..STEP * column + WINDOW] {
                    for (moment, sum) in moments.iter_mut().zip(sums) {
                        *moment += sum;
                    }
                }
                let (x, y) = (STEP * column + WINDOW / 2, STEP * row + WINDOW / 2);
                let near = range.map_or(1.0, |range| 1.0 - range.row(0, y)[x].to_f64());
                windows.push(moments.map(|sum| sum / (WINDOW * WINDOW) as f64), near * near);
            }
        }
        windows
    }

    /// Adds a window from the means of a, b, a², b² and ab, and the factor of its weight due to range.
    fn push(&mut self, [a, b, aa, bb, ab]: [f64; 5], near: f64) {
        let (va, vb, cov) = ((aa - a * a).max(0.0), bb - b * b, ab - a * b);
        let flat = vb <= 0.0;
        let vb = vb.max(0.0);
        let scale = 1.0 / ((va + VARIANCE_FLOOR) * (vb + VARIANCE_FLOOR)).sqrt();
        let ncc = cov * scale;
        let weight = near * (va / (va + HALF_WEIGHT));
        self.weight += weight;
        self.lost += weight * (1.0 - ncc);
        let samples = (WINDOW * WINDOW) as f64;
        let alpha = -weight * scale / samples;
        let beta = if flat {
            0.0
        } else {
            weight * ncc / (vb + VARIANCE_FLOOR) / samples
        };
        self.slopes
            .push([alpha, beta, -(alpha * a + beta * b)].map(T::from_f64));
    }

    /// Adds the gradient of `factor * lost` to that of a picture.
    fn add_gradient(&self, gradient: &mut Tensor<T>, axis: [f64; 3], factor: f64) {
        let width = self.before.width;
        let mut sums = vec![[T::default(); 3]; self.before.data.len()];
        let mut line = vec![[T::default(); 3]; width];
        for (row, slopes) in self.slopes.chunks(self.columns.max(1)).enumerate() {
            line.fill([T::default(); 3]);
            for (column, slopes) in slopes.iter().enumerate() {
                for sums in &mut line[STEP * column..STEP * column + WINDOW] {
                    for (sum, &slope) in sums.iter_mut().zip(slopes) {
                        *sum += slope;
                    }
                }
            }
            for y in STEP * row..STEP * row + WINDOW {
                for (sums, line) in sums[y * width..(y + 1) * width].iter_mut().zip(&line) {
                    for (sum, &value) in sums.iter_mut().zip(line) {
                        *sum += value;
                    }
                }
            }
        }
        for (channel, share) in axis.into_iter().enumerate() {
            let share = T::from_f64(share * factor);
            let samples = self.before.data.iter().zip(&self.after.data).zip(&sums);
            for (gradient, ((&a, &b), &[alpha, beta, gamma])) in
                gradient.plane_mut(channel).iter_mut().zip(samples)
            {
                *gradient += (alpha * a + beta * b + gamma) * share;
            }
        }
    }
}

/// Compares a level along its color axes.
fn compare_level<T: Real>(
    before: &Tensor<T>,
    after: &Tensor<T>,
    range: Option<&Tensor<T>>,
    level: usize,
) -> Vec<Windows<T>> {
    let axes = if level == 0 { &AXES[..1] } else { &AXES[..] };
    axes.iter()
        .map(|&(axis, _)| Windows::new(project(before, axis), project(after, axis), range))
        .collect()
}
