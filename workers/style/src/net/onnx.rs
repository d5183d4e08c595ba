//! The network as an ONNX file: one fixed graph around the trained numbers.
//!
//! The graph, for an image `x` of any size in 0..=1:
//!
//! ```text
//! c = relu(reduce(relu(enter(mean of each 4×4 pixels of x))))         reduce goes in steps of 2
//! c = c + mix_b(spread_b(relu(mix_a(spread_a(c)))))                    twice
//! h = relu(pixel(x) + resize(leave(c), bilinear, to the size of x))
//! styled = clamp(colour(x) + output(h), 0, 1)
//! ```
//!
//! Filters of side 3 continue a picture by its edge. Opset 17, float32.

use std::borrow::Cow;

use super::layer::{BLOCKS, COLOUR, ENTER, LAYERS, LEAVE, Layer, OUTPUT, PARAMETERS, PIXEL, REDUCE, Weights};
use super::wire::{Value, bytes, fields, integer};

const IR_VERSION: i64 = 8;
const OPSET: i64 = 17;
/// ONNX's numbers of element types.
const FLOAT: i64 = 1;
const INT64: i64 = 7;

/// The ONNX file of a network; `metadata` are pairs of key and value that say where it comes from.
#[must_use]
pub fn write(weights: &Weights, metadata: &[(&str, &str)]) -> Vec<u8> {
    let mut model = Vec::new();
    integer(&mut model, 1, IR_VERSION);
    bytes(&mut model, 2, b"fathom");
    bytes(&mut model, 7, &graph(weights));
    let mut opset = Vec::new();
    integer(&mut opset, 2, OPSET);
    bytes(&mut model, 8, &opset);
    for (key, value) in metadata {
        let mut entry = Vec::new();
        bytes(&mut entry, 1, key.as_bytes());
        bytes(&mut entry, 2, value.as_bytes());
        bytes(&mut model, 14, &entry);
    }
    model
}

/// The numbers of a network in an ONNX file, if its graph is this one to the last byte; any other graph is nothing to
/// this module.
#[must_use]
pub fn read(file: &[u8]) -> Option<Weights> {
    let mut found = None;
    let mut version = None;
    for field in fields(file) {
        match field? {
            (1, Value::Integer(ir)) => version = Some(ir),
            (7, Value::Bytes(graph)) if found.is_none() => found = Some(graph),
            (7, _) => return None,
            (8, Value::Bytes(opset)) => {
                let expected = [0x10, OPSET as u8];
                if opset != expected {
                    return None;
                }
            }
            // Functions, training information: nothing that this module knows.
            (20.., _) => return None,
            _ => {}
        }
    }
    let found = found.filter(|_| version == Some(IR_VERSION as u64))?;
    let mut values = Vec::with_capacity(PARAMETERS);
    for layer in LAYERS {
        for (name, length) in [("weight", layer.weights()), ("bias", layer.outputs)] {
            values.extend(floats(found, &format!("{}.{name}", layer.name), length)?);
        }
    }
    let weights = Weights::new(values)?;
    let finite = weights.values().iter().all(|value| value.is_finite());
    (finite && graph(&weights) == found).then_some(weights)
}

/// The raw numbers of an initializer.
fn floats(graph: &[u8], name: &str, length: usize) -> Option<impl Iterator<Item = f32>> {
    for field in fields(graph) {
        let (5, Value::Bytes(tensor)) = field? else {
            continue;
        };
        let mut called = false;
        let mut raw = None;
        for field in fields(tensor) {
            match field? {
                (8, Value::Bytes(text)) => called = text == name.as_bytes(),
                (9, Value::Bytes(data)) => raw = Some(data),
                _ => {}
            }
        }
        if called {
            let raw = raw.filter(|raw| raw.len() == 4 * length)?;
            return Some(
                raw.chunks_exact(4)
                    .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])),
            );
        }
    }
    None
}

fn graph(weights: &Weights) -> Vec<u8> {
    let mut graph = Graph::default();
    graph.node(
        "AveragePool",
        &["image"],
        "pooled",
        &[
            ("kernel_shape", &Attribute::Integers(&[4, 4])),
            ("strides", &Attribute::Integers(&[4, 4])),
            ("ceil_mode", &Attribute::Integer(1)),
        ],
    );
    graph.convolution(ENTER, "pooled", "entered", 1);
    graph.node("Relu", &["entered"], "quarter", &[]);
    graph.convolution(REDUCE, "quarter", "reduced", 2);
    graph.node("Relu", &["reduced"], "context0", &[]);
    for (index, [spread_a, mix_a, spread_b, mix_b]) in BLOCKS.into_iter().enumerate() {
        let name = |what: &str| format!("block{index}.{what}");
        let (before, after) = (format!("context{index}"), format!("context{}", index + 1));
        graph.convolution(spread_a, &before, &name("spread_a"), 1);
        graph.convolution(mix_a, &name("spread_a"), &name("mix_a"), 1);
        graph.node("Relu", &[&name("mix_a")], &name("relu"), &[]);
        graph.convolution(spread_b, &name("relu"), &name("spread_b"), 1);
        graph.convolution(mix_b, &name("spread_b"), &name("mix_b"), 1);
        graph.node("Add", &[&before, &name("mix_b")], &after, &[]);
    }
    graph.convolution(LEAVE, "context2", "left", 1);
    graph.node("Shape", &["left"], "left.shape", &[]);
    graph.node("Shape", &["image"], "image.shape", &[]);
    graph.node("Slice", &["left.shape", "zero", "two"], "channels", &[]);
    graph.node("Slice", &["image.shape", "two", "four"], "sides", &[]);
    let axis = Attribute::Integer(0);
    graph.node("Concat", &["channels", "sides"], "size", &[("axis", &axis)]);
    graph.node(
        "Resize",
        &["left", "", "", "size"],
        "resized",
        &[
            ("coordinate_transformation_mode", &Attribute::Text("half_pixel")),
            ("mode", &Attribute::Text("linear")),
        ],
    );
    graph.convolution(PIXEL, "image", "pixel", 1);
    graph.node("Add", &["pixel", "resized"], "both", &[]);
    graph.node("Relu", &["both"], "features", &[]);
    graph.convolution(OUTPUT, "features", "texture", 1);
    graph.convolution(COLOUR, "image", "toned", 1);
    graph.node("Add", &["toned", "texture"], "sum", &[]);
    graph.node("Clip", &["sum", "black", "white"], "styled", &[]);
    graph.finish(weights)
}

enum Attribute<'a> {
    Integer(i64),
    Integers(&'a [i64]),
    Text(&'a str),
}

/// Nodes as they come; tensors, inputs and outputs follow them in the file, by their field numbers.
#[derive(Default)]
struct Graph {
    message: Vec<u8>,
}

impl Graph {
    fn node(&mut self, operator: &str, inputs: &[&str], output: &str, attributes: &[(&str, &Attribute<'_>)]) {
        let mut node = Vec::new();
        for input in inputs {
            bytes(&mut node, 1, input.as_bytes());
        }
        bytes(&mut node, 2, output.as_bytes());
        bytes(&mut node, 3, output.as_bytes());
        bytes(&mut node, 4, operator.as_bytes());
        for (name, value) in attributes {
            bytes(&mut node, 5, &attribute(name, value));
        }
        bytes(&mut self.message, 1, &node);
    }

    /// A convolution, after padding by the edge where its filters have side 3.
    fn convolution(&mut self, layer: Layer, input: &str, output: &str, step: i64) {
        let mut input = Cow::Borrowed(input);
        if layer.side == 3 {
            let padded = format!("{}.padded", layer.name);
            let mode = Attribute::Text("edge");
            self.node("Pad", &[&input, "border"], &padded, &[("mode", &mode)]);
            input = Cow::Owned(padded);
        }
        let (weight, bias) = (format!("{}.weight", layer.name), format!("{}.bias", layer.name));
        let groups = if layer.inputs == 1 { layer.outputs } else { 1 };
        let side = layer.side as i64;
        self.node(
            "Conv",
            &[&input, &weight, &bias],
            output,
            &[
                ("group", &Attribute::Integer(groups as i64)),
                ("kernel_shape", &Attribute::Integers(&[side, side])),
                ("strides", &Attribute::Integers(&[step, step])),
            ],
        );
    }

    fn finish(mut self, weights: &Weights) -> Vec<u8> {
        let message = &mut self.message;
        bytes(message, 2, b"fathom_style");
        let raw = |values: &[f32]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
        for layer in LAYERS {
            let sides = [layer.outputs, layer.inputs, layer.side, layer.side].map(|side| side as i64);
            let (weight, bias) = (format!("{}.weight", layer.name), format!("{}.bias", layer.name));
            bytes(
                message,
                5,
                &tensor(&weight, FLOAT, &sides, &raw(weights.weight(layer))),
            );
            bytes(
                message,
                5,
                &tensor(&bias, FLOAT, &sides[..1], &raw(weights.bias(layer))),
            );
        }
        let integers: [(&str, &[i64]); 4] = [
            ("border", &[0, 0, 1, 1, 0, 0, 1, 1]),
            ("zero", &[0]),
            ("two", &[2]),
            ("four", &[4]),
        ];
        for (name, values) in integers {
            let raw: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
            bytes(message, 5, &tensor(name, INT64, &[values.len() as i64], &raw));
        }
        for (name, value) in [("black", 0.0), ("white", 1.0)] {
            bytes(message, 5, &tensor(name, FLOAT, &[], &raw(&[value])));
        }
        bytes(message, 11, &port("image"));
        bytes(message, 12, &port("styled"));
        self.message
    }
}

fn attribute(name: &str, value: &Attribute<'_>) -> Vec<u8> {
    let mut message = Vec::new();
    bytes(&mut message, 1, name.as_bytes());
    let kind = match value {
        Attribute::Integer(value) => {
            integer(&mut message, 3, *value);
            2
        }
        Attribute::Text(text) => {
            bytes(&mut message, 4, text.as_bytes());
            3
        }
        Attribute::Integers(values) => {
            for &value in *values {
                integer(&mut message, 8, value);
            }
            7
        }
    };
    integer(&mut message, 20, kind);
    message
}

fn tensor(name: &str, kind: i64, sides: &[i64], raw: &[u8]) -> Vec<u8> {
    let mut message = Vec::new();
    for &side in sides {
        integer(&mut message, 1, side);
    }
    integer(&mut message, 2, kind);
    bytes(&mut message, 8, name.as_bytes());
    bytes(&mut message, 9, raw);
    message
}

/// An input or output: float32 of shape [n, 3, h, w].
fn port(name: &str) -> Vec<u8> {
    let mut shape = Vec::new();
    for side in ["n", "", "h", "w"] {
        let mut dimension = Vec::new();
        match side {
            "" => integer(&mut dimension, 1, 3),
            open => bytes(&mut dimension, 2, open.as_bytes()),
        }
        bytes(&mut shape, 1, &dimension);
    }
    let mut tensor = Vec::new();
    integer(&mut tensor, 1, FLOAT);
    bytes(&mut tensor, 2, &shape);
    let mut kind = Vec::new();
    bytes(&mut kind, 1, &tensor);
    let mut message = Vec::new();
    bytes(&mut message, 1, name.as_bytes());
    bytes(&mut message, 2, &kind);
    message
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some() -> Weights {
        Weights::new((0..PARAMETERS).map(|i| (i as f32 * 0.37).fract() - 0.5).collect()).unwrap()
    }

    #[test]
    fn the_numbers_come_back_from_the_file_and_metadata_does_not_matter() {
        for metadata in [&[][..], &[("seed", "7"), ("photo", "none")]] {
            assert_eq!(read(&write(&some(), metadata)).unwrap(), some());
        }
    }

    #[test]
    fn a_file_that_differs_anywhere_in_its_graph_is_another_network() {
        let file = write(&some(), &[]);
        let replaced = |from: &[u8], to: &[u8]| {
            let at = file
                .windows(from.len())
                .position(|window| window == from)
                .unwrap();
            let mut file = file.clone();
            file[at..at + to.len()].copy_from_slice(to);
            read(&file)
        };
        assert_eq!(replaced(b"half_pixel", b"asymmetric"), None);
        assert_eq!(replaced(b"Clip", b"Floo"), None);
        assert_eq!(replaced(b"Relu", b"Sqrt"), None);
        let nan = f32::NAN.to_le_bytes();
        assert_eq!(replaced(&some().weight(REDUCE)[0].to_le_bytes(), &nan), None);
        assert_eq!(read(b""), None);
        assert_eq!(read(b"no model at all"), None);
        for end in [1, 100, file.len() / 2, file.len() - 1] {
            assert_eq!(read(&file[..end]), None, "{end}");
        }
    }
}
