//! Step 3 by running sums.

use imaging::{Plane, vectorized};
use spec::Mlle;

use crate::blocks::window_mean;
use crate::variant::Variant;

/// Partial sums of the moments.
const LANES: usize = 8;

/// The new lightness, in 0..=1 before clipping.
pub(super) fn contrasted(lightness: Plane<f64>, parameters: &Mlle) -> Plane<f64> {
    let (width, height) = lightness.size();
    let radius = parameters.window_px / 2;
    let mut products = Plane::filled(width, height, 0.0);
    vectorized!(multiply(lightness.data(), lightness.data(), products.data_mut()));
    let [mean, mut variance] = window_mean([&lightness, &products], radius, Variant::Fast);
    let all = vectorized!(variance_of_all(lightness.data(), products.data()));
    let mut expanded = lightness.clone();
    let gains = Gains {
        all,
        most: parameters.contrast_max,
    };
    vectorized!(gains.expand(mean.data(), variance.data_mut(), expanded.data_mut()));
    vectorized!(multiply(lightness.data(), expanded.data(), products.data_mut()));
    let [mut offset, mut slope] = window_mean([&expanded, &products], radius, Variant::Fast);
    drop((expanded, products));
    let windows = [mean.data(), variance.data()];
    vectorized!(fit(
        windows,
        parameters.guide_eps,
        slope.data_mut(),
        offset.data_mut()
    ));
    drop((mean, variance));
    let [slope, offset] = window_mean([&slope, &offset], radius, Variant::Fast);
    let mut contrasted = lightness;
    vectorized!(apply(slope.data(), offset.data(), contrasted.data_mut()));
    contrasted
}

#[inline(always)]
fn multiply(a: &[f64], b: &[f64], products: &mut [f64]) {
    for (product, (a, b)) in products.iter_mut().zip(a.iter().zip(b)) {
        *product = a * b;
    }
}

/// The variance of the whole picture from its values and their squares.
#[inline(always)]
fn variance_of_all(values: &[f64], squares: &[f64]) -> f64 {
    let [mean, square] = [values, squares].map(|values| {
        let mut sums = [0.0; LANES];
        let (blocks, rest) = values.as_chunks::<LANES>();
        for block in blocks {
            for x in 0..LANES {
                sums[x] += block[x];
            }
        }
        (sums.iter().sum::<f64>() + rest.iter().sum::<f64>()) / values.len() as f64
    });
    (square - mean * mean).max(0.0)
}

/// Limits of the gains of contrast.
struct Gains {
    /// Variance of the whole picture.
    all: f64,
    /// β.
    most: f64,
}

impl Gains {
    /// `E` in place of L, and the variance in place of the mean square.
    #[inline(always)]
    fn expand(&self, means: &[f64], squares: &mut [f64], values: &mut [f64]) {
        let (all, most) = (self.all, self.most);
        for (value, (mean, square)) in values.iter_mut().zip(means.iter().zip(squares)) {
            let variance = *square - mean * mean;
            let variance = if variance > 0.0 { variance } else { 0.0 };
            *square = variance;
            // Infinite or not a number without variance, and then not selected.
            let ratio = all / variance;
            let gain = if variance * most > all { ratio } else { most };
            *value = mean + gain * (*value - mean);
        }
    }
}

/// `a` in place of the mean product, and `b` in place of the mean of E.
#[inline(always)]
fn fit([means, variances]: [&[f64]; 2], eps: f64, slopes: &mut [f64], offsets: &mut [f64]) {
    let windows = means.iter().zip(variances);
    for ((slope, offset), (mean, variance)) in slopes.iter_mut().zip(offsets).zip(windows) {
        *slope = (*slope - mean * *offset) / (variance + eps);
        *offset -= *slope * mean;
    }
}

#[inline(always)]
fn apply(slopes: &[f64], offsets: &[f64], values: &mut [f64]) {
    for (value, (slope, offset)) in values.iter_mut().zip(slopes.iter().zip(offsets)) {
        *value = slope * *value + offset;
    }
}
