//! Hand-written gradients against finite differences in f64; f32 differences are too coarse.

#![allow(clippy::unwrap_used)]

use imaging::random::Stream;
use style::net::layer::{OUTPUT, Weights};
use training::loss::pyramid::Pyramid;
use training::loss::{Ranges, losses};
use training::network::{backward, forward, ranged};
use training::tensor::Tensor;

/// Rounding of central differences of sums of order 1.
const OF_NETWORK: f64 = 1e-4;
/// The same, plus patches whose order changes within the step.
const OF_LOSSES: f64 = 1e-3;
const STEP: f64 = 1e-7;

fn noise(seed: u64, channels: usize, height: usize, width: usize) -> Tensor<f64> {
    let stream = Stream::stage(seed, "gradients");
    let mut tensor = Tensor::zeros(channels, height, width);
    for (at, value) in tensor.data.iter_mut().enumerate() {
        *value = stream.unit(0, at as u64);
    }
    tensor
}

fn weights(takes_range: bool) -> Weights<f64> {
    let stream = Stream::stage(3, "gradients");
    let mut weights = Weights::zeros(takes_range);
    for (index, &layer) in weights.clone().layers().iter().enumerate() {
        let reach = 1.0 / (layer.fan_in() as f64).sqrt();
        let (weight, bias) = weights.layer_mut(layer);
        bias.fill(if layer == OUTPUT { 0.2 } else { 0.3 });
        for (at, value) in weight.iter_mut().enumerate() {
            *value = (2.0 * stream.unit(index as u64, at as u64) - 1.0) * reach;
        }
    }
    weights
}

fn product(one: &Tensor<f64>, other: &Tensor<f64>) -> f64 {
    one.data.iter().zip(&other.data).map(|(a, b)| a * b).sum()
}

/// Odd sides exercise every border: 37 pixels, 10 means, 5 samples of context.
#[test]
fn the_network_s_gradient_is_that_of_finite_differences_in_every_layer() {
    let (image, direction) = (noise(1, 3, 33, 37), noise(2, 3, 33, 37));
    let weights = weights(true);
    let ranged = ranged(&image, &noise(3, 1, 33, 37));
    let run = |weights: &Weights<f64>| forward(weights, &image, Some(&ranged));
    let gradient = backward(&weights, &run(&weights), &direction);
    let value = |weights: &Weights<f64>| product(&run(weights).styled, &direction);
    for &layer in weights.layers() {
        let (weight, bias) = (gradient.weight(layer), gradient.bias(layer));
        let largest = weight.iter().chain(bias).fold(0.0f64, |m, v| m.max(v.abs()));
        assert!(largest > 0.0, "{}", layer.name);
        for at in (0..weight.len() + bias.len()).step_by(5) {
            let moved = |by: f64| {
                let mut moved = weights.clone();
                let (weight, bias) = moved.layer_mut(layer);
                *weight.iter_mut().chain(bias).nth(at).unwrap() += by;
                value(&moved)
            };
            let difference = (moved(STEP) - moved(-STEP)) / (2.0 * STEP);
            let found = *weight.iter().chain(bias).nth(at).unwrap();
            let error = (found - difference).abs() / largest;
            assert!(
                error < OF_NETWORK,
                "{} {at}: {found} is not {difference}",
                layer.name
            );
        }
    }
}

/// Along random directions, since a single sample moves the loss too little.
#[test]
fn the_losses_gradient_is_that_of_finite_differences() {
    let stream = Stream::stage(9, "gradients");
    let pyramids = |seeds: [u64; 2], channels| seeds.map(|seed| Pyramid::new(noise(seed, channels, 64, 72)));
    let contents = pyramids([4, 5], 3);
    let style = [Pyramid::new(noise(6, 3, 80, 96))];
    let (near, far) = (pyramids([41, 51], 1), [Pyramid::new(noise(61, 1, 80, 96))]);
    let by_range = Ranges {
        contents: &near,
        style: &far,
    };
    // Values below 0 and above 1, to include the excess.
    let result = |seed| {
        let mut result = noise(seed, 3, 64, 72);
        result
            .data
            .iter_mut()
            .for_each(|value| *value = 1.4 * *value - 0.2);
        result
    };
    let results = vec![result(7), result(8)];
    for ranges in [None, Some(by_range)] {
        let (_, gradients) = losses(&contents, results.clone(), &style, ranges, &stream, 2);
        for seed in 0..6 {
            let directions: Vec<_> = (0..2).map(|at| noise(20 + 2 * seed + at, 3, 64, 72)).collect();
            let moved = |by: f64| {
                let mut moved = results.clone();
                for (result, direction) in moved.iter_mut().zip(&directions) {
                    for (value, direction) in result.data.iter_mut().zip(&direction.data) {
                        *value += by * (direction - 0.5);
                    }
                }
                losses(&contents, moved, &style, ranges, &stream, 2).0.total()
            };
            let difference = (moved(STEP) - moved(-STEP)) / (2.0 * STEP);
            let product = |(gradient, direction): (&Tensor<f64>, &Tensor<f64>)| {
                let pairs = gradient.data.iter().zip(&direction.data);
                pairs.map(|(a, b)| a * (b - 0.5)).sum::<f64>()
            };
            let found: f64 = gradients.iter().zip(&directions).map(product).sum();
            let error = (found - difference).abs() / difference.abs();
            assert!(error < OF_LOSSES, "direction {seed}: {found} is not {difference}");
        }
    }
}
