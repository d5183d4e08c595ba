//! The network for one picture, forward with all that the way back needs, and back.

use style::net::layer::{BLOCKS, COLOUR, ENTER, LEAVE, OUTPUT, PIXEL, REDUCE, Weights};

use crate::layer::{filter, mix, scale};
use crate::real::Real;
use crate::tensor::Tensor;

/// What a run has made, kept for the way back. Bordered tensors are what the filters saw.
pub struct Trace<T> {
    /// The result before it is clamped.
    pub styled: Tensor<T>,
    image: Tensor<T>,
    image_padded: Tensor<T>,
    pooled_padded: Tensor<T>,
    quarter: Tensor<T>,
    quarter_padded: Tensor<T>,
    context: Tensor<T>,
    blocks: [BlockTrace<T>; 2],
    leave_padded: Tensor<T>,
    features: Tensor<T>,
    features_padded: Tensor<T>,
}

struct BlockTrace<T> {
    input_padded: Tensor<T>,
    spread_a: Tensor<T>,
    relu: Tensor<T>,
    relu_padded: Tensor<T>,
    spread_b: Tensor<T>,
}

/// Runs the network on a picture of three channels.
#[must_use]
pub fn forward<T: Real>(weights: &Weights<T>, image: &Tensor<T>) -> Trace<T> {
    let at = |layer| (weights.weight(layer), weights.bias(layer));
    let filter = |layer, input: &Tensor<T>, step| {
        let (weight, bias) = at(layer);
        filter::forward(input, weight, bias, step)
    };
    let pooled_padded = scale::pooled(image).padded();
    let mut quarter = filter(ENTER, &pooled_padded, 1);
    quarter.relu();
    let quarter_padded = quarter.padded();
    let mut context = filter(REDUCE, &quarter_padded, 2);
    context.relu();
    let mut now = context.clone();
    let blocks = BLOCKS.map(|[spread_a, mix_a, spread_b, mix_b]| {
        let each = |layer, input: &Tensor<T>| {
            let (weight, bias) = at(layer);
            filter::forward_each(input, weight, bias)
        };
        let mixed = |layer, input: &Tensor<T>| {
            let (weight, bias) = at(layer);
            mix::forward(input, weight, bias)
        };
        let input_padded = now.padded();
        let spread_a = each(spread_a, &input_padded);
        let mut relu = mixed(mix_a, &spread_a);
        relu.relu();
        let relu_padded = relu.padded();
        let spread_b = each(spread_b, &relu_padded);
        now.add(&mixed(mix_b, &spread_b));
        BlockTrace {
            input_padded,
            spread_a,
            relu,
            relu_padded,
            spread_b,
        }
    });
    let leave_padded = now.padded();
    let left = filter(LEAVE, &leave_padded, 1);
    let image_padded = image.padded();
    let mut features = filter(PIXEL, &image_padded, 1);
    features.add(&scale::resized(&left, image.height, image.width));
    features.relu();
    let features_padded = features.padded();
    let mut styled = filter(OUTPUT, &features_padded, 1);
    let (weight, bias) = at(COLOUR);
    styled.add(&mix::forward(image, weight, bias));
    Trace {
        styled,
        image: image.clone(),
        image_padded,
        pooled_padded,
        quarter,
        quarter_padded,
        context,
        blocks,
        leave_padded,
        features,
        features_padded,
    }
}

/// The gradient of all numbers of the network from that of its result.
#[must_use]
pub fn backward<T: Real>(weights: &Weights<T>, trace: &Trace<T>, gradient: &Tensor<T>) -> Weights<T> {
    let mut sums = Weights::zeros();
    mix::backward_weights(&trace.image, gradient, sums.layer_mut(COLOUR));
    filter::backward_weights(&trace.features_padded, gradient, 1, sums.layer_mut(OUTPUT));
    let size = (trace.features_padded.height, trace.features_padded.width);
    let mut features = filter::backward_input(gradient, weights.weight(OUTPUT), 8, size, 1).unpadded();
    features.unrelu(&trace.features);
    filter::backward_weights(&trace.image_padded, &features, 1, sums.layer_mut(PIXEL));

    let (height, width) = (trace.context.height, trace.context.width);
    let left = scale::unresized(&features, height, width);
    filter::backward_weights(&trace.leave_padded, &left, 1, sums.layer_mut(LEAVE));
    let size = (height + 2, width + 2);
    let mut context = filter::backward_input(&left, weights.weight(LEAVE), 16, size, 1).unpadded();
    for (block, layers) in trace.blocks.iter().zip(BLOCKS).rev() {
        let through = backward_block(weights, block, layers, &context, &mut sums);
        context.add(&through);
    }
    context.unrelu(&trace.context);
    filter::backward_weights(&trace.quarter_padded, &context, 2, sums.layer_mut(REDUCE));
    let size = (trace.quarter_padded.height, trace.quarter_padded.width);
    let mut quarter = filter::backward_input(&context, weights.weight(REDUCE), 8, size, 2).unpadded();
    quarter.unrelu(&trace.quarter);
    filter::backward_weights(&trace.pooled_padded, &quarter, 1, sums.layer_mut(ENTER));
    sums
}

/// The gradient through the branch of a residual block.
fn backward_block<T: Real>(
    weights: &Weights<T>,
    trace: &BlockTrace<T>,
    [spread_a, mix_a, spread_b, mix_b]: [style::net::layer::Layer; 4],
    gradient: &Tensor<T>,
    sums: &mut Weights<T>,
) -> Tensor<T> {
    mix::backward_weights(&trace.spread_b, gradient, sums.layer_mut(mix_b));
    let gradient = mix::backward_input(gradient, weights.weight(mix_b), 16);
    filter::backward_weights_each(&trace.relu_padded, &gradient, sums.layer_mut(spread_b));
    let mut gradient = filter::backward_input_each(&gradient, weights.weight(spread_b)).unpadded();
    gradient.unrelu(&trace.relu);
    mix::backward_weights(&trace.spread_a, &gradient, sums.layer_mut(mix_a));
    let gradient = mix::backward_input(&gradient, weights.weight(mix_a), 16);
    filter::backward_weights_each(&trace.input_padded, &gradient, sums.layer_mut(spread_a));
    filter::backward_input_each(&gradient, weights.weight(spread_a)).unpadded()
}
