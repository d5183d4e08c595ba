//! The network of the style waters for training: forward with a trace, and its gradient.
//!
//! ```text
//! c = relu(reduce(relu(enter(mean of each 4×4 pixels of x))))         reduce has stride 2
//! c = c + mix_b(spread_b(relu(mix_a(spread_a(c)))))                    twice
//! h = relu(pixel(x) + resize(leave(c), bilinear, to the size of x))
//! styled = color(x) + output(h)                                       not clamped
//! ```
//!
//! With a range q of each pixel and `r = (q x, q)`, `range_pixel(r)` is added to the argument of `h`, and
//! `range_color(r)` to the result.

use style::net::layer::{
    BLOCKS, COLOR, ENTER, LEAVE, Layer, OUTPUT, PIXEL, RANGE_COLOR, RANGE_PIXEL, REDUCE, Weights,
};

use crate::layer::{filter, mix, scale};
use crate::real::Real;
use crate::tensor::Tensor;

/// Intermediate results of a forward run, kept for the gradient.
pub struct ForwardTrace<T> {
    /// The result before clamping.
    pub styled: Tensor<T>,
    /// Input of each layer, with borders for 3×3 filters.
    inputs: Vec<(Layer, Tensor<T>)>,
    /// The context before the blocks.
    context: Tensor<T>,
}

impl<T> ForwardTrace<T> {
    fn input(&self, layer: Layer) -> &Tensor<T> {
        let found = self.inputs.iter().find(|(known, _)| *known == layer);
        &found.expect("a layer that ran").1
    }
}

/// The colors of a picture times their range, and the range: the second input of a network with a range.
#[must_use]
pub fn ranged<T: Real>(image: &Tensor<T>, range: &Tensor<T>) -> Tensor<T> {
    let mut out = Tensor::zeros(4, image.height, image.width);
    for channel in 0..3 {
        let pairs = image.plane(channel).iter().zip(range.plane(0));
        for (out, (&color, &range)) in out.plane_mut(channel).iter_mut().zip(pairs) {
            *out = color * range;
        }
    }
    out.plane_mut(3).copy_from_slice(range.plane(0));
    out
}

/// Runs the network on a picture of three channels. `ranged` is [`ranged()`] for a network with a range.
#[must_use]
pub fn forward<T: Real>(
    weights: &Weights<T>,
    image: &Tensor<T>,
    ranged: Option<&Tensor<T>>,
) -> ForwardTrace<T> {
    let mut inputs = Vec::with_capacity(weights.layers().len());
    let mut apply = |layer: Layer, input: &Tensor<T>, step| {
        let (weight, bias) = (weights.weight(layer), weights.bias(layer));
        let input = if layer.side == 3 {
            input.padded()
        } else {
            input.clone()
        };
        let out = match layer.side {
            3 => filter::forward(&input, weight, bias, step),
            _ => mix::forward(&input, weight, bias),
        };
        inputs.push((layer, input));
        out
    };
    let quarter = apply(ENTER, &scale::pooled(image), 1).relu();
    let context = apply(REDUCE, &quarter, 2).relu();
    let mut now = context.clone();
    for [spread_a, mix_a, spread_b, mix_b] in BLOCKS {
        let spread = apply(spread_a, &now, 1);
        let mixed = apply(mix_a, &spread, 1).relu();
        let spread = apply(spread_b, &mixed, 1);
        now.add(&apply(mix_b, &spread, 1));
    }
    let left = apply(LEAVE, &now, 1);
    let mut features = apply(PIXEL, image, 1);
    features.add(&scale::resized(&left, image.height, image.width));
    if let Some(ranged) = ranged {
        features.add(&apply(RANGE_PIXEL, ranged, 1));
    }
    let mut styled = apply(OUTPUT, &features.relu(), 1);
    styled.add(&apply(COLOR, image, 1));
    if let Some(ranged) = ranged {
        styled.add(&apply(RANGE_COLOR, ranged, 1));
    }
    ForwardTrace {
        styled,
        inputs,
        context,
    }
}

/// The gradient of all parameters of the network from that of its result.
#[must_use]
pub fn backward<T: Real>(weights: &Weights<T>, trace: &ForwardTrace<T>, gradient: &Tensor<T>) -> Weights<T> {
    let mut sums = Weights::zeros(weights.takes_range());
    let mut learn = |layer: Layer, gradient: &Tensor<T>, step| match layer.side {
        3 => filter::backward_weights(trace.input(layer), gradient, step, sums.layer_mut(layer)),
        _ => mix::backward_weights(trace.input(layer), gradient, sums.layer_mut(layer)),
    };
    // The gradient of a filter's input; behind a ReLU, zero where the ReLU was closed.
    let backpropagate = |layer: Layer, gradient: &Tensor<T>, step, behind_relu| {
        let input = trace.input(layer);
        let mut back = filter::backward_input(gradient, weights.weight(layer), input, step);
        if behind_relu {
            back.unrelu(input);
        }
        back.unpadded()
    };
    learn(COLOR, gradient, 1);
    learn(OUTPUT, gradient, 1);
    let features = backpropagate(OUTPUT, gradient, 1, true);
    learn(PIXEL, &features, 1);
    if weights.takes_range() {
        learn(RANGE_COLOR, gradient, 1);
        learn(RANGE_PIXEL, &features, 1);
    }
    let left = scale::unresized(&features, trace.context.height, trace.context.width);
    learn(LEAVE, &left, 1);
    let mut context = backpropagate(LEAVE, &left, 1, false);
    for [spread_a, mix_a, spread_b, mix_b] in BLOCKS.into_iter().rev() {
        learn(mix_b, &context, 1);
        let spread = mix::backward_input(&context, weights.weight(mix_b), mix_b.inputs);
        learn(spread_b, &spread, 1);
        let mixed = backpropagate(spread_b, &spread, 1, true);
        learn(mix_a, &mixed, 1);
        let spread = mix::backward_input(&mixed, weights.weight(mix_a), mix_a.inputs);
        learn(spread_a, &spread, 1);
        context.add(&backpropagate(spread_a, &spread, 1, false));
    }
    context.unrelu(&trace.context);
    learn(REDUCE, &context, 2);
    learn(ENTER, &backpropagate(REDUCE, &context, 2, true), 1);
    sums
}
