//! The layers of the network and their parameters, all in one list.

/// A convolution with bias.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layer {
    /// Name of the layer; its tensors are `NAME.weight` and `NAME.bias`.
    pub name: &'static str,
    /// Output channels.
    pub outputs: usize,
    /// Input channels per output: 1 for depthwise filters.
    pub inputs: usize,
    /// Side of the filter: 3 or 1.
    pub side: usize,
    /// Start of its weights in the list, `[output][input][row][column]`; the biases follow.
    start: usize,
}

impl Layer {
    const fn first(name: &'static str, outputs: usize, inputs: usize, side: usize) -> Self {
        Self {
            name,
            outputs,
            inputs,
            side,
            start: 0,
        }
    }

    const fn then(self, name: &'static str, outputs: usize, inputs: usize, side: usize) -> Self {
        Self {
            name,
            outputs,
            inputs,
            side,
            start: self.end(),
        }
    }

    /// Number of weights.
    #[must_use]
    pub const fn weights(self) -> usize {
        self.outputs * self.inputs * self.side * self.side
    }

    const fn end(self) -> usize {
        self.start + self.weights() + self.outputs
    }

    /// Inputs per output sample: inputs × side².
    #[must_use]
    pub const fn fan_in(self) -> usize {
        self.inputs * self.side * self.side
    }
}

/// Context at a quarter of the resolution: 3 → 8 channels.
pub const ENTER: Layer = Layer::first("enter", 8, 3, 3);
/// From a quarter to an eighth of the resolution: 8 → 16 channels.
pub const REDUCE: Layer = ENTER.then("reduce", 16, 8, 3);
/// The two residual blocks: depthwise, mix, ReLU, depthwise, mix.
pub const BLOCKS: [[Layer; 4]; 2] = {
    let first = block(
        REDUCE,
        [
            "block0.spread_a",
            "block0.mix_a",
            "block0.spread_b",
            "block0.mix_b",
        ],
    );
    let second = block(
        first[3],
        [
            "block1.spread_a",
            "block1.mix_a",
            "block1.spread_b",
            "block1.mix_b",
        ],
    );
    [first, second]
};
/// From the context to the features of a pixel: 16 → 8 channels.
pub const LEAVE: Layer = BLOCKS[1][3].then("leave", 8, 16, 3);
/// Features of a pixel at full resolution: 3 → 8 channels.
pub const PIXEL: Layer = LEAVE.then("pixel", 8, 3, 3);
/// From the features to the correction of the color map: 8 → 3 channels.
pub const OUTPUT: Layer = PIXEL.then("output", 3, 8, 3);
/// The affine color map: 3 → 3 channels.
pub const COLOR: Layer = OUTPUT.then("colour", 3, 3, 1);

/// Features of a pixel from its range, and from its color times its range: 4 → 8 channels. Only in networks with a
/// range.
pub const RANGE_PIXEL: Layer = COLOR.then("range_pixel", 8, 4, 3);
/// Range-dependent correction of the color map: 4 → 3 channels. Only in networks with a range.
pub const RANGE_COLOR: Layer = RANGE_PIXEL.then("range_color", 3, 4, 1);

/// All layers of a network with a range, in list order; those of a network without one come first.
const ALL: [Layer; 16] = {
    let [a, b] = BLOCKS;
    [
        ENTER,
        REDUCE,
        a[0],
        a[1],
        a[2],
        a[3],
        b[0],
        b[1],
        b[2],
        b[3],
        LEAVE,
        PIXEL,
        OUTPUT,
        COLOR,
        RANGE_PIXEL,
        RANGE_COLOR,
    ]
};

/// Number of parameters of a network without a range.
pub const PARAMETERS: usize = COLOR.end();
/// Number of parameters of a network with a range.
pub const RANGE_PARAMETERS: usize = RANGE_COLOR.end();

/// All layers of a network with or without a range.
#[must_use]
pub fn layers(takes_range: bool) -> &'static [Layer] {
    if takes_range { &ALL } else { &ALL[..14] }
}

const fn block(after: Layer, names: [&'static str; 4]) -> [Layer; 4] {
    let spread_a = after.then(names[0], 16, 1, 3);
    let mix_a = spread_a.then(names[1], 16, 16, 1);
    let spread_b = mix_a.then(names[2], 16, 1, 3);
    let mix_b = spread_b.then(names[3], 16, 16, 1);
    [spread_a, mix_a, spread_b, mix_b]
}

/// The parameters of a network, layer after layer.
#[derive(Debug, Clone, PartialEq)]
pub struct Weights<T = f32> {
    values: Vec<T>,
}

impl<T> Weights<T> {
    /// Accepts [`PARAMETERS`] or [`RANGE_PARAMETERS`] numbers, layer after layer; `None` for any other count.
    #[must_use]
    pub fn new(values: Vec<T>) -> Option<Self> {
        [PARAMETERS, RANGE_PARAMETERS]
            .contains(&values.len())
            .then_some(Self { values })
    }

    /// Whether the network has a range input.
    #[must_use]
    pub fn takes_range(&self) -> bool {
        self.values.len() == RANGE_PARAMETERS
    }

    /// Its layers, in list order.
    #[must_use]
    pub fn layers(&self) -> &'static [Layer] {
        layers(self.takes_range())
    }

    /// All parameters.
    #[must_use]
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// All parameters.
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// The weights of a layer, `[output][input][row][column]`.
    #[must_use]
    pub fn weight(&self, layer: Layer) -> &[T] {
        &self.values[layer.start..layer.start + layer.weights()]
    }

    /// The biases of a layer.
    #[must_use]
    pub fn bias(&self, layer: Layer) -> &[T] {
        &self.values[layer.start + layer.weights()..layer.end()]
    }

    /// The weights and the biases of a layer.
    pub fn layer_mut(&mut self, layer: Layer) -> (&mut [T], &mut [T]) {
        self.values[layer.start..layer.end()].split_at_mut(layer.weights())
    }

    /// The same network in another number type.
    pub fn map<U>(&self, number: impl FnMut(&T) -> U) -> Weights<U> {
        Weights {
            values: self.values.iter().map(number).collect(),
        }
    }
}

impl<T: Clone + Default> Weights<T> {
    /// A network of zeros.
    #[must_use]
    pub fn zeros(takes_range: bool) -> Self {
        let count = if takes_range { RANGE_PARAMETERS } else { PARAMETERS };
        Self {
            values: vec![T::default(); count],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_layers_fill_the_list_without_a_gap() {
        let mut position = 0;
        for (index, layer) in ALL.into_iter().enumerate() {
            assert_eq!(layer.start, position, "{}", layer.name);
            position = layer.end();
            assert_eq!(index == 13, position == PARAMETERS, "{}", layer.name);
        }
        assert_eq!((PARAMETERS, RANGE_PARAMETERS, position), (4735, 5046, 5046));
    }
}
