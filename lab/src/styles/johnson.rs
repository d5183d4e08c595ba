//! The network of fast neural style (Johnson, Alahi and Fei-Fei 2016, with instance normalization by Ulyanov, Vedaldi and
//! Lempitsky 2016) with random weights: a control that shows the effect of the architecture alone.

use imaging::random::Stream;

use style::net::onnx::{Attribute, ConvolutionShape, Graph, model};

/// Channels at full, half and quarter resolution.
const CHANNELS: [usize; 3] = [32, 64, 128];
/// Residual blocks.
const BLOCKS: usize = 5;

/// The ONNX file: 9×9 to 32 channels, two reductions to 64 and 128, five residual blocks, two enlargements, 9×9 to three
/// channels, clamped to 0..=1.
pub(super) fn johnson(seed: u64) -> Vec<u8> {
    let mut net = Builder {
        graph: Graph::default(),
        stream: Stream::stage(seed, "johnson"),
        layers: 0,
    };
    let [full, half, quarter] = CHANNELS;
    let mut now = net.stage("image", (3, full), 9, 1, true);
    now = net.stage(&now, (full, half), 3, 2, true);
    now = net.stage(&now, (half, quarter), 3, 2, true);
    for block in 0..BLOCKS {
        let first = net.stage(&now, (quarter, quarter), 3, 1, true);
        let second = net.stage(&first, (quarter, quarter), 3, 1, false);
        let sum = format!("block{block}");
        net.graph.node("Add", &[&now, &second], &sum, &[]);
        now = sum;
    }
    for (index, sizes) in [(quarter, half), (half, full)].into_iter().enumerate() {
        let large = format!("enlarged{index}");
        let mode = Attribute::Text("nearest");
        net.graph
            .node("Resize", &[&now, "", "scales"], &large, &[("mode", &mode)]);
        now = net.stage(&large, sizes, 3, 1, true);
    }
    let last = net.convolution(&now, (full, 3), 9, 1);
    net.graph.node("Clip", &[&last, "black", "white"], "styled", &[]);
    net.graph.integers("border1", &[0, 0, 1, 1, 0, 0, 1, 1]);
    net.graph.integers("border4", &[0, 0, 4, 4, 0, 0, 4, 4]);
    net.graph.floats("scales", &[4], &[1.0, 1.0, 2.0, 2.0]);
    net.graph.floats("black", &[], &[0.0]);
    net.graph.floats("white", &[], &[1.0]);
    model(&net.graph.finish("johnson"), &[])
}

struct Builder {
    graph: Graph,
    stream: Stream,
    layers: u64,
}

impl Builder {
    /// Convolution, instance normalization, and ReLU if there is one.
    fn stage(&mut self, input: &str, sizes: (usize, usize), side: usize, step: i64, relu: bool) -> String {
        let made = self.convolution(input, sizes, side, step);
        let (scale, shift) = (format!("{made}.scale"), format!("{made}.shift"));
        let channels = [sizes.1 as i64];
        self.graph.floats(&scale, &channels, &vec![1.0; sizes.1]);
        self.graph.floats(&shift, &channels, &vec![0.0; sizes.1]);
        let normal = format!("{made}.normal");
        self.graph
            .node("InstanceNormalization", &[&made, &scale, &shift], &normal, &[]);
        if !relu {
            return normal;
        }
        let positive = format!("{made}.relu");
        self.graph.node("Relu", &[&normal], &positive, &[]);
        positive
    }

    /// A convolution with reflected borders and random weights. The last one is centered at middle gray.
    fn convolution(&mut self, input: &str, (from, to): (usize, usize), side: usize, step: i64) -> String {
        let name = format!("layer{}", self.layers);
        let form = ConvolutionShape {
            side: side as i64,
            step,
            groups: 1,
            padding: Some((if side == 9 { "border4" } else { "border1" }, "reflect")),
        };
        let fan_in = from * side * side;
        let reach = 1.0 / (fan_in as f64).sqrt();
        let weights: Vec<f32> = (0..(to * fan_in) as u64)
            .map(|index| ((2.0 * self.stream.unit(self.layers, index) - 1.0) * reach) as f32)
            .collect();
        let bias = if to == 3 { 0.5 } else { 0.0 };
        self.graph.convolution(&name, (input, &name), form);
        let sides = [to, from, side, side].map(|side| side as i64);
        self.graph.floats(&format!("{name}.weight"), &sides, &weights);
        self.graph
            .floats(&format!("{name}.bias"), &sides[..1], &vec![bias; to]);
        self.layers += 1;
        name
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use imaging::Rgb;
    use style::{Runtime, Session, StyleModel};

    use super::johnson;

    /// The network loads and runs like any user's.
    #[test]
    fn a_network_with_instance_normalization_loads_and_runs() {
        let model = StyleModel::without_card("johnson", johnson(1));
        assert!(model.needs_runtime() && Session::native(&model).is_none());
        let mut session = Runtime::load(None).unwrap().session(&model).unwrap();
        let frame = Rgb::from_fn(45, 38, |x, y| [x as f32 / 45.0, y as f32 / 38.0, 0.3]);
        let styled = session.apply(&frame, style::ModelInputs::default()).unwrap();
        assert_eq!(styled.size(), (45, 38));
        let red = styled.planes()[0].data();
        assert!(red.iter().any(|&value| (value - red[0]).abs() > 0.01));
    }
}
