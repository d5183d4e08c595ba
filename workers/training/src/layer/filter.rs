//! 3×3 filters on bordered channels, and their gradients.

use std::ops::Range;

use imaging::vectorized;

use crate::real::Real;
use crate::tensor::Tensor;

/// Partial sums of a dot product: a fixed number, so that its bits do not depend on the CPU.
const LANES: usize = 8;

/// The input channels of an output: all of them, or a single one for depthwise filters.
fn seen(output: usize, kernels: usize, channels: usize) -> Range<usize> {
    match kernels {
        1 => output..output + 1,
        _ => 0..channels,
    }
}

/// `out[o] = bias[o] + sum of in[i] * weight[o][i]` over bordered channels, with stride 1 or 2.
pub(crate) fn forward<T: Real>(input: &Tensor<T>, weight: &[T], bias: &[T], step: usize) -> Tensor<T> {
    let (width, height) = (
        (input.width - 2).div_ceil(step),
        (input.height - 2).div_ceil(step),
    );
    let mut out = Tensor::zeros(bias.len(), height, width);
    let kernels = weight.len() / 9 / bias.len();
    vectorized!({
        for output in 0..bias.len() {
            out.plane_mut(output).fill(bias[output]);
            let taps = weight[9 * kernels * output..].chunks_exact(9);
            for (channel, taps) in seen(output, kernels, input.channels).zip(taps) {
                for y in 0..height {
                    for row in 0..3 {
                        let samples = input.row(channel, step * y + row);
                        let taps = [taps[3 * row], taps[3 * row + 1], taps[3 * row + 2]];
                        add_row(out.row_mut(output, y), samples, taps, step);
                    }
                }
            }
        }
    });
    out
}

#[inline(always)]
fn add_row<T: Real>(out: &mut [T], samples: &[T], [a, b, c]: [T; 3], step: usize) {
    let width = out.len();
    if step == 1 {
        let (left, middle, right) = (&samples[..width], &samples[1..=width], &samples[2..width + 2]);
        for x in 0..width {
            out[x] += a * left[x] + b * middle[x] + c * right[x];
        }
    } else {
        for (x, out) in out.iter_mut().enumerate() {
            let window = &samples[step * x..step * x + 3];
            *out += a * window[0] + b * window[1] + c * window[2];
        }
    }
}

/// Accumulates the gradients of weight and bias.
pub(crate) fn backward_weights<T: Real>(
    input: &Tensor<T>,
    gradient: &Tensor<T>,
    step: usize,
    (weight, bias): (&mut [T], &mut [T]),
) {
    let kernels = weight.len() / 9 / bias.len();
    vectorized!({
        for output in 0..gradient.channels {
            bias[output] += total(gradient.plane(output));
            let taps = weight[9 * kernels * output..].chunks_exact_mut(9);
            for (channel, taps) in seen(output, kernels, input.channels).zip(taps) {
                add_taps(input, channel, gradient, output, step, taps);
            }
        }
    });
}

#[inline(always)]
fn add_taps<T: Real>(
    input: &Tensor<T>,
    channel: usize,
    gradient: &Tensor<T>,
    output: usize,
    step: usize,
    taps: &mut [T],
) {
    for row in 0..3 {
        let mut sums = [[T::default(); LANES]; 3];
        for y in 0..gradient.height {
            let (gradient, samples) = (gradient.row(output, y), input.row(channel, step * y + row));
            if step == 1 {
                dots(gradient, samples, &mut sums);
            } else {
                for (x, &gradient) in gradient.iter().enumerate() {
                    for (column, sums) in sums.iter_mut().enumerate() {
                        sums[0] += gradient * samples[step * x + column];
                    }
                }
            }
        }
        for (tap, sums) in taps[3 * row..3 * row + 3].iter_mut().zip(&sums) {
            *tap += total(sums);
        }
    }
}

/// Products of the gradient with the samples at the offsets 0, 1 and 2 to the right.
#[inline(always)]
fn dots<T: Real>(gradient: &[T], samples: &[T], sums: &mut [[T; LANES]; 3]) {
    let whole = gradient.len() / LANES * LANES;
    for x in (0..whole).step_by(LANES) {
        let gradient = &gradient[x..x + LANES];
        let samples = &samples[x..x + LANES + 2];
        for (column, sums) in sums.iter_mut().enumerate() {
            let samples = &samples[column..column + LANES];
            for lane in 0..LANES {
                sums[lane] += gradient[lane] * samples[lane];
            }
        }
    }
    for x in whole..gradient.len() {
        for (column, sums) in sums.iter_mut().enumerate() {
            sums[x - whole] += gradient[x] * samples[x + column];
        }
    }
}

#[inline(always)]
fn total<T: Real>(values: &[T]) -> T {
    let mut sum = T::default();
    for &value in values {
        sum += value;
    }
    sum
}

/// The gradient of the bordered input.
pub(crate) fn backward_input<T: Real>(
    gradient: &Tensor<T>,
    weight: &[T],
    input: &Tensor<T>,
    step: usize,
) -> Tensor<T> {
    let mut out = input.like();
    let kernels = weight.len() / 9 / gradient.channels;
    vectorized!({
        for output in 0..gradient.channels {
            let taps = weight[9 * kernels * output..].chunks_exact(9);
            for (channel, taps) in seen(output, kernels, input.channels).zip(taps) {
                spread_channel(gradient, output, taps, &mut out, channel, step);
            }
        }
    });
    out
}

#[inline(always)]
fn spread_channel<T: Real>(
    gradient: &Tensor<T>,
    output: usize,
    taps: &[T],
    out: &mut Tensor<T>,
    channel: usize,
    step: usize,
) {
    for y in 0..gradient.height {
        let gradient = gradient.row(output, y);
        for row in 0..3 {
            let out = out.row_mut(channel, step * y + row);
            let taps = &taps[3 * row..3 * row + 3];
            if step == 1 {
                spread_row(gradient, [taps[0], taps[1], taps[2]], out);
            } else {
                for (x, &gradient) in gradient.iter().enumerate() {
                    for (out, &tap) in out[step * x..step * x + 3].iter_mut().zip(taps) {
                        *out += gradient * tap;
                    }
                }
            }
        }
    }
}

/// `out[x + k] += gradient[x] * tap[k]`.
#[inline(always)]
fn spread_row<T: Real>(gradient: &[T], [a, b, c]: [T; 3], out: &mut [T]) {
    let width = gradient.len();
    if width < 2 {
        for (out, tap) in out.iter_mut().zip([a, b, c]) {
            *out += gradient[0] * tap;
        }
        return;
    }
    out[0] += gradient[0] * a;
    out[1] += gradient[1] * a + gradient[0] * b;
    let inner = &mut out[2..width];
    let length = inner.len();
    let (left, middle, right) = (
        &gradient[..length],
        &gradient[1..=length],
        &gradient[2..length + 2],
    );
    for x in 0..length {
        inner[x] += right[x] * a + middle[x] * b + left[x] * c;
    }
    out[width] += gradient[width - 1] * b + gradient[width - 2] * c;
    out[width + 1] += gradient[width - 1] * c;
}
