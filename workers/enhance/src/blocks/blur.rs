//! Gaussian window along rows and columns, with replicated borders.

use imaging::{Plane, vectorized};

use crate::variant::Variant;

/// The mean over a window of `2 radius + 1` pixels a side with the weights `exp(-(i² + j²) / (2 σ²))`, which add up
/// to 1.
#[must_use]
pub fn gaussian(plane: &Plane<f64>, radius: usize, sigma_px: f64, variant: Variant) -> Plane<f64> {
    let weights = weights(radius, sigma_px);
    match variant {
        Variant::Fast => vectorized!(passes(plane, &weights)),
        Variant::Reference => reference(plane, &weights),
    }
}

fn weights(radius: usize, sigma_px: f64) -> Vec<f64> {
    let weights = (0..=radius).map(|i| (-0.5 * (i as f64 / sigma_px).powi(2)).exp());
    let weights: Vec<f64> = weights.collect();
    let sum = 1.0 + 2.0 * weights[1..].iter().sum::<f64>();
    weights.into_iter().map(|weight| weight / sum).collect()
}

/// Index of the sample at `i - radius`, clamped to `0..n`.
fn clamp_index(i: usize, radius: usize, n: usize) -> usize {
    i.saturating_sub(radius).min(n - 1)
}

fn reference(plane: &Plane<f64>, weights: &[f64]) -> Plane<f64> {
    let (width, height) = plane.size();
    let radius = weights.len() - 1;
    let rows = Plane::from_fn(width, height, |x, y| {
        let window = (0..=2 * radius)
            .map(|i| weights[i.abs_diff(radius)] * plane.pixel(clamp_index(x + i, radius, width), y));
        window.sum::<f64>()
    });
    Plane::from_fn(width, height, |x, y| {
        let window = (0..=2 * radius)
            .map(|i| weights[i.abs_diff(radius)] * rows.pixel(x, clamp_index(y + i, radius, height)));
        window.sum::<f64>()
    })
}

/// Samples whose sums stay in registers: eight vectors of four.
const BLOCK: usize = 32;

/// Blurs down the columns, then along the new row while it is in the nearest cache.
#[inline(always)]
fn passes(plane: &Plane<f64>, weights: &[f64]) -> Plane<f64> {
    let (width, height) = plane.size();
    let radius = weights.len() - 1;
    let stride = width.div_ceil(BLOCK) * BLOCK;
    let mut padded = vec![0.0f64; stride * height];
    let rows = plane.data().chunks_exact(width);
    for (to, from) in padded.chunks_exact_mut(stride).zip(rows) {
        to[..width].copy_from_slice(from);
    }
    let mut line = vec![0.0f64; stride + 2 * radius];
    let mut blurred = Plane::filled(width, height, 0.0f64);
    for y in 0..height {
        let rows = (0..=2 * radius).map(|i| &padded[clamp_index(y + i, radius, height) * stride..][..stride]);
        let rows: Vec<&[f64]> = rows.collect();
        for start in (0..stride).step_by(BLOCK) {
            let sums = weighted(|i| &rows[i][start..start + BLOCK], weights);
            line[radius + start..][..BLOCK].copy_from_slice(&sums);
        }
        for i in 0..radius {
            line[i] = line[radius + clamp_index(i, radius, width)];
            line[radius + width + i] = line[radius + clamp_index(radius + width + i, radius, width)];
        }
        for start in (0..width).step_by(BLOCK) {
            let end = (start + BLOCK).min(width);
            let sums = weighted(|i| &line[start + i..start + i + BLOCK], weights);
            blurred.row_mut(y)[start..end].copy_from_slice(&sums[..end - start]);
        }
    }
    blurred
}

/// The weighted sum of `2 radius + 1` runs of samples.
#[inline(always)]
fn weighted<'a>(run: impl Fn(usize) -> &'a [f64], weights: &[f64]) -> [f64; BLOCK] {
    let radius = weights.len() - 1;
    let mut sums = [0.0f64; BLOCK];
    for (sum, &value) in sums.iter_mut().zip(run(radius)) {
        *sum = weights[0] * value;
    }
    for (i, &weight) in weights.iter().enumerate().skip(1) {
        let (before, after) = (&run(radius - i)[..BLOCK], &run(radius + i)[..BLOCK]);
        for x in 0..BLOCK {
            sums[x] += weight * (before[x] + after[x]);
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_impulse_becomes_the_window() {
        let impulse = Plane::from_fn(21, 21, |x, y| if (x, y) == (10, 10) { 1.0 } else { 0.0 });
        for variant in [Variant::Fast, Variant::Reference] {
            let blurred = gaussian(&impulse, 4, 9.0, variant);
            assert!((blurred.data().iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert_eq!(blurred.pixel(15, 10), 0.0);
            let ratio = blurred.pixel(13, 12) / blurred.pixel(10, 10);
            assert!((ratio - (-13.0f64 / 162.0).exp()).abs() < 1e-12, "{ratio}");
        }
    }

    #[test]
    fn a_window_larger_than_the_picture_repeats_its_border() {
        let plane = Plane::new(3, 1, vec![0.0, 3.0, 9.0]).unwrap();
        for variant in [Variant::Fast, Variant::Reference] {
            // 32 times 0, once 3, 32 times 9.
            let middle = gaussian(&plane, 32, 1e6, variant).pixel(1, 0);
            assert!((middle - 291.0 / 65.0).abs() < 1e-6, "{middle}");
        }
    }
}
