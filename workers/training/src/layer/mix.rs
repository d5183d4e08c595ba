//! Pointwise mixing of channels, and its gradients.

use imaging::vectorized;

use crate::real::Real;
use crate::tensor::Tensor;

/// `out[o] = bias[o] + sum of weight[o][i] * in[i]`.
pub(crate) fn forward<T: Real>(input: &Tensor<T>, weight: &[T], bias: &[T]) -> Tensor<T> {
    let mut out = Tensor::zeros(bias.len(), input.height, input.width);
    vectorized!({
        for output in 0..bias.len() {
            let plane = out.plane_mut(output);
            plane.fill(bias[output]);
            for channel in 0..input.channels {
                add_scaled(
                    plane,
                    input.plane(channel),
                    weight[output * input.channels + channel],
                );
            }
        }
    });
    out
}

/// The gradient of the input.
pub(crate) fn backward_input<T: Real>(gradient: &Tensor<T>, weight: &[T], channels: usize) -> Tensor<T> {
    let mut out = Tensor::zeros(channels, gradient.height, gradient.width);
    vectorized!({
        for channel in 0..channels {
            for output in 0..gradient.channels {
                let weight = weight[output * channels + channel];
                add_scaled(out.plane_mut(channel), gradient.plane(output), weight);
            }
        }
    });
    out
}

/// Accumulates the gradients of weight and bias.
pub(crate) fn backward_weights<T: Real>(
    input: &Tensor<T>,
    gradient: &Tensor<T>,
    (weight, bias): (&mut [T], &mut [T]),
) {
    vectorized!({
        for output in 0..gradient.channels {
            let gradient = gradient.plane(output);
            for &value in gradient {
                bias[output] += value;
            }
            for channel in 0..input.channels {
                weight[output * input.channels + channel] += dot(gradient, input.plane(channel));
            }
        }
    });
}

#[inline(always)]
fn add_scaled<T: Real>(sums: &mut [T], values: &[T], factor: T) {
    for (sum, &value) in sums.iter_mut().zip(values) {
        *sum += value * factor;
    }
}

#[inline(always)]
fn dot<T: Real>(one: &[T], other: &[T]) -> T {
    const LANES: usize = 8;
    let mut sums = [T::default(); LANES];
    let (ones, others) = (one.chunks_exact(LANES), other.chunks_exact(LANES));
    let rest = ones.remainder().iter().zip(others.remainder());
    for (one, other) in ones.zip(others) {
        for lane in 0..LANES {
            sums[lane] += one[lane] * other[lane];
        }
    }
    let mut sum = T::default();
    for (&one, &other) in rest {
        sum += one * other;
    }
    for lane in sums {
        sum += lane;
    }
    sum
}
