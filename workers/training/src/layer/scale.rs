//! Means of 4×4 pixels, bilinear upsampling, halving; and the gradients needed by training.

use crate::real::Real;
use crate::tensor::Tensor;

/// Means of 4×4 pixels, clipped at the right and lower edge.
pub(crate) fn pooled<T: Real>(image: &Tensor<T>) -> Tensor<T> {
    let mut out = Tensor::zeros(image.channels, image.height.div_ceil(4), image.width.div_ceil(4));
    for channel in 0..image.channels {
        for y in 0..out.height {
            let rows = 4 * y..(4 * y + 4).min(image.height);
            let count = rows.len();
            for row in rows {
                let samples = image.row(channel, row).chunks(4);
                for (sum, samples) in out.row_mut(channel, y).iter_mut().zip(samples) {
                    let share = T::from_f64(1.0 / (count * samples.len()) as f64);
                    for &sample in samples {
                        *sum += sample * share;
                    }
                }
            }
        }
    }
    out
}

/// For each sample of an upsampled line: lower source sample, upper source sample, weight of the latter.
struct Upsampling<T>(Vec<(usize, usize, T)>);

impl<T: Real> Upsampling<T> {
    /// Pixel centers at half integers, clamped to the edge.
    fn new(from: usize, to: usize) -> Self {
        let samples = (0..to).map(|i| {
            let exact = ((i as f64 + 0.5) * from as f64 / to as f64 - 0.5).clamp(0.0, (from - 1) as f64);
            let low = exact as usize;
            (low, (low + 1).min(from - 1), T::from_f64(exact - low as f64))
        });
        Self(samples.collect())
    }
}

/// Bilinear enlargement.
pub(crate) fn resized<T: Real>(input: &Tensor<T>, height: usize, width: usize) -> Tensor<T> {
    let (rows, columns) = (
        Upsampling::<T>::new(input.height, height),
        Upsampling::<T>::new(input.width, width),
    );
    let mut wide = Tensor::zeros(input.channels, input.height, width);
    for channel in 0..input.channels {
        for y in 0..input.height {
            let source = input.row(channel, y);
            let target = wide.row_mut(channel, y).iter_mut();
            for (target, &(low, high, share)) in target.zip(&columns.0) {
                *target = source[low] + (source[high] - source[low]) * share;
            }
        }
    }
    let mut out = Tensor::zeros(input.channels, height, width);
    for channel in 0..input.channels {
        for (y, &(low, high, share)) in rows.0.iter().enumerate() {
            let pairs = wide.row(channel, low).iter().zip(wide.row(channel, high));
            for (target, (&low, &high)) in out.row_mut(channel, y).iter_mut().zip(pairs) {
                *target = low + (high - low) * share;
            }
        }
    }
    out
}

/// The gradient before [`resized`] from the one after it.
pub(crate) fn unresized<T: Real>(gradient: &Tensor<T>, height: usize, width: usize) -> Tensor<T> {
    let (rows, columns) = (
        Upsampling::<T>::new(height, gradient.height),
        Upsampling::<T>::new(width, gradient.width),
    );
    let unit = T::from_f64(1.0);
    let mut wide: Tensor<T> = Tensor::zeros(gradient.channels, height, gradient.width);
    for channel in 0..gradient.channels {
        for (y, &(low, high, share)) in rows.0.iter().enumerate() {
            for (row, share) in [(low, unit - share), (high, share)] {
                let sums = wide.row_mut(channel, row).iter_mut();
                for (sum, &value) in sums.zip(gradient.row(channel, y)) {
                    *sum += value * share;
                }
            }
        }
    }
    let mut out = Tensor::zeros(gradient.channels, height, width);
    for channel in 0..gradient.channels {
        for y in 0..height {
            let target = out.row_mut(channel, y);
            for (&value, &(low, high, share)) in wide.row(channel, y).iter().zip(&columns.0) {
                target[low] += value * (unit - share);
                target[high] += value * share;
            }
        }
    }
    out
}

/// Means of 2×2 pixels, without an odd last row or column.
pub(crate) fn halved<T: Real>(image: &Tensor<T>) -> Tensor<T> {
    let quarter = T::from_f64(0.25);
    let mut out = Tensor::zeros(image.channels, image.height / 2, image.width / 2);
    for channel in 0..image.channels {
        for y in 0..out.height {
            let upper = image.row(channel, 2 * y).chunks_exact(2);
            let lower = image.row(channel, 2 * y + 1).chunks_exact(2);
            for (to, (a, b)) in out.row_mut(channel, y).iter_mut().zip(upper.zip(lower)) {
                *to = (a[0] + a[1] + b[0] + b[1]) * quarter;
            }
        }
    }
    out
}

/// Adds the gradient before [`halved`] from the one after it.
pub(crate) fn unhalved<T: Real>(gradient: &Tensor<T>, sums: &mut Tensor<T>) {
    let quarter = T::from_f64(0.25);
    for channel in 0..gradient.channels {
        for y in 0..2 * gradient.height {
            let source = gradient.row(channel, y / 2);
            for (pair, &value) in sums.row_mut(channel, y).chunks_exact_mut(2).zip(source) {
                pair[0] += value * quarter;
                pair[1] += value * quarter;
            }
        }
    }
}
