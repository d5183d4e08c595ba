//! Weights in the order of the inner loop.

use crate::net::layer::{Layer, Weights};

/// The weights of a layer, in groups of `OUT` outputs: `[group][input][tap][output of the group]`.
#[derive(Debug, Clone)]
pub(super) struct Packed<const OUT: usize> {
    pub(super) groups: Vec<OutputGroup<OUT>>,
    pub(super) taps: usize,
}

/// `OUT` outputs of a layer.
#[derive(Debug, Clone)]
pub(super) struct OutputGroup<const OUT: usize> {
    /// `[input × taps + tap]`, for all outputs of the group.
    pub(super) weights: Vec<[f32; OUT]>,
    pub(super) bias: [f32; OUT],
}

impl<const OUT: usize> Packed<OUT> {
    pub(super) fn new(weights: &Weights, layer: Layer) -> Self {
        let (weight, bias) = (weights.weight(layer), weights.bias(layer));
        let taps = layer.side * layer.side;
        let groups = (0..layer.outputs / OUT).map(|group| OutputGroup {
            weights: (0..layer.inputs * taps)
                .map(|i| std::array::from_fn(|o| weight[(group * OUT + o) * layer.inputs * taps + i]))
                .collect(),
            bias: std::array::from_fn(|o| bias[group * OUT + o]),
        });
        Self {
            groups: groups.collect(),
            taps,
        }
    }

    /// Fuses two layers whose outputs are added into one over the channels of both.
    pub(super) fn join(&mut self, other: Self) {
        for (group, other) in self.groups.iter_mut().zip(other.groups) {
            group.weights.extend(other.weights);
            for (bias, other) in group.bias.iter_mut().zip(other.bias) {
                *bias += other;
            }
        }
    }
}
