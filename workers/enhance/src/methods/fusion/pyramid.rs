//! Step 5 in single precision. Weights add up to 1, so one Laplacian pyramid of the difference of the inputs is enough.

use imaging::{Plane, vectorized};

use crate::blocks::{blend_rows, weighted};

/// The levels of a plane, the finest first.
pub(super) fn gaussian(plane: Plane<f32>, levels: usize) -> Vec<Plane<f32>> {
    let mut pyramid = vec![plane];
    while pyramid.len() < levels {
        pyramid.push(reduce(&pyramid[pyramid.len() - 1]));
    }
    pyramid
}

/// A plane of half the sides.
fn reduce(plane: &Plane<f32>) -> Plane<f32> {
    let (width, height) = plane.size();
    let mut half = Plane::filled(width.div_ceil(2), height.div_ceil(2), 0.0);
    // A sample more than the blur needs, so that the last pair is whole.
    let mut line = vec![0.0; width + 5];
    for y in 0..half.height() {
        vectorized!({
            blend_rows(plane, 2 * y, &mut line[..width + 4]);
            halve(&line, half.row_mut(y));
        });
    }
    half
}

/// Every second sample of a blended row, blurred.
#[inline(always)]
fn halve(line: &[f32], half: &mut [f32]) {
    let (pairs, _) = line.as_chunks::<2>();
    let n = half.len();
    let taps = pairs[..n].iter().zip(&pairs[1..=n]).zip(&pairs[2..]);
    for (to, ((ab, cd), e)) in half.iter_mut().zip(taps) {
        *to = weighted([ab[0], ab[1], cd[0], cd[1], e[0]]);
    }
}

/// The collapsed `G_l(W) L_l(D)` at the finest level, row by row: `finish(y, row)` receives each of them.
pub(super) fn collapse(
    weights: &[Plane<f32>],
    details: &[Plane<f32>],
    mut finish: impl FnMut(usize, &[f32]),
) {
    let coarsest = weights.len() - 1;
    let mut sum = details[coarsest].clone();
    vectorized!(multiply(sum.data_mut(), weights[coarsest].data()));
    for level in (1..coarsest).rev() {
        let mut finer = details[level].clone();
        let mut doubling = Doubling::new(finer.width());
        for y in 0..finer.height() {
            let detail = details[level].row(y);
            let next = Some((&sum, &details[level + 1]));
            vectorized!(doubling.blend(next, y, weights[level].row(y), detail, finer.row_mut(y)));
        }
        sum = finer;
    }
    let (width, height) = details[0].size();
    let mut doubling = Doubling::new(width);
    let mut row = vec![0.0; width];
    for y in 0..height {
        let next = (coarsest > 0).then(|| (&sum, &details[1]));
        vectorized!(doubling.blend(next, y, weights[0].row(y), details[0].row(y), &mut row));
        finish(y, &row);
    }
}

#[inline(always)]
fn multiply(values: &mut [f32], factors: &[f32]) {
    for (value, factor) in values.iter_mut().zip(factors) {
        *value *= factor;
    }
}

/// Scratch rows of one level.
struct Doubling {
    /// A row between the rows of the coarser level, with one replicated sample on either side.
    between: Vec<f32>,
    sum: Vec<f32>,
    detail: Vec<f32>,
}

impl Doubling {
    fn new(width: usize) -> Self {
        Self {
            between: vec![0.0; width.div_ceil(2) + 2],
            sum: vec![0.0; width],
            detail: vec![0.0; width],
        }
    }

    /// Row `y` of `double(sum) + W (D - double(coarser D))`; without a coarser level `W D`.
    #[inline(always)]
    fn blend(
        &mut self,
        next: Option<(&Plane<f32>, &Plane<f32>)>,
        y: usize,
        weights: &[f32],
        details: &[f32],
        blended: &mut [f32],
    ) {
        if let Some((sum, coarser)) = next {
            double_row(sum, y, &mut self.between, &mut self.sum);
            double_row(coarser, y, &mut self.between, &mut self.detail);
        }
        let doubled = self.sum.iter().zip(&self.detail);
        for ((to, (sum, coarse)), (weight, detail)) in
            blended.iter_mut().zip(doubled).zip(weights.iter().zip(details))
        {
            *to = sum + weight * (detail - coarse);
        }
    }
}

/// Row `y` of a level at the size of the next finer one.
#[inline(always)]
fn double_row(coarse: &Plane<f32>, y: usize, between: &mut [f32], doubled: &mut [f32]) {
    let (width, height) = coarse.size();
    let half = y / 2;
    let own = coarse.row(half);
    let after = coarse.row((half + 1).min(height - 1));
    let line = &mut between[1..=width];
    if y % 2 == 1 {
        for ((to, own), after) in line.iter_mut().zip(own).zip(after) {
            *to = 0.5 * (own + after);
        }
    } else {
        let before = coarse.row(half.saturating_sub(1));
        for ((to, own), (before, after)) in line.iter_mut().zip(own).zip(before.iter().zip(after)) {
            *to = 0.125 * (before + after) + 0.75 * own;
        }
    }
    between[0] = between[1];
    between[width + 1] = between[width];
    let (pairs, rest) = doubled.as_chunks_mut::<2>();
    let taps = between[..width].iter().zip(&between[1..]).zip(&between[2..]);
    for (pair, ((before, own), after)) in pairs.iter_mut().zip(taps) {
        *pair = [0.125 * (before + after) + 0.75 * own, 0.5 * (own + after)];
    }
    if let [last] = rest {
        *last = 0.125 * (between[width - 1] + between[width + 1]) + 0.75 * between[width];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn with_equal_weights_the_pyramid_returns_the_plane() {
        for (width, height) in [(1, 1), (2, 1), (1, 5), (7, 4), (33, 18)] {
            let plane = Plane::from_fn(width, height, |x, y| ((7 * x + 11 * y) % 13) as f32 / 13.0);
            let levels = 1 + width.min(height).ilog2() as usize;
            let details = gaussian(plane.clone(), levels);
            let weights = gaussian(Plane::filled(width, height, 0.25), levels);
            assert_eq!(details[levels - 1].width(), width.div_ceil(1 << (levels - 1)));
            let mut rows = 0;
            collapse(&weights, &details, |y, row| {
                rows += 1;
                for (got, expected) in row.iter().zip(plane.row(y)) {
                    assert!((got - 0.25 * expected).abs() < 1e-6, "{got} for {expected}");
                }
            });
            assert_eq!(rows, height);
        }
    }
}
