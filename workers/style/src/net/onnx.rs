//! The network as an ONNX file: one fixed graph around the parameters.
//!
//! The graph, for an image `x` of any size in 0..=1:
//!
//! ```text
//! c = relu(reduce(relu(enter(mean of each 4×4 pixels of x))))         reduce has stride 2
//! c = c + mix_b(spread_b(relu(mix_a(spread_a(c)))))                    twice
//! h = relu(pixel(x) + resize(leave(c), bilinear, to the size of x))
//! styled = clamp(color(x) + output(h), 0, 1)
//! ```
//!
//! A network with a range has a second input q, 0 at the camera and 1 far away, and with `r = (q x, q)`
//!
//! ```text
//! h = relu(pixel(x) + range_pixel(r) + resize(leave(c), bilinear, to the size of x))
//! styled = clamp(color(x) + range_color(r) + output(h), 0, 1)
//! ```
//!
//! 3×3 filters extend a picture by its edge. Opset 17, float32.

mod graph;

use super::layer::{
    BLOCKS, COLOR, ENTER, LEAVE, Layer, OUTPUT, PIXEL, RANGE_COLOR, RANGE_PARAMETERS, RANGE_PIXEL, REDUCE,
    Weights, layers,
};
use super::wire::{WireValue, bytes, fields, integer, messages};

pub use graph::{Attribute, ConvolutionShape, Graph};

const IR_VERSION: i64 = 8;
const OPSET: i64 = 17;

/// The ONNX file of a network; `metadata` are key-value pairs about its provenance.
#[must_use]
pub fn write(weights: &Weights, metadata: &[(&str, &str)]) -> Vec<u8> {
    model(&graph(weights), metadata)
}

/// The ONNX file of a graph.
#[must_use]
pub fn model(graph: &[u8], metadata: &[(&str, &str)]) -> Vec<u8> {
    let mut model = Vec::new();
    integer(&mut model, 1, IR_VERSION);
    bytes(&mut model, 2, b"fathom");
    bytes(&mut model, 7, graph);
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

/// The weights of a network in an ONNX file, or `None` unless its graph is exactly this one.
#[must_use]
pub fn read(file: &[u8]) -> Option<Weights> {
    let mut found = None;
    let mut version = None;
    for field in fields(file) {
        match field? {
            (1, WireValue::Integer(ir)) => version = Some(ir),
            (7, WireValue::Bytes(graph)) if found.is_none() => found = Some(graph),
            (7, _) => return None,
            (8, WireValue::Bytes(opset)) => {
                let expected = [0x10, OPSET as u8];
                if opset != expected {
                    return None;
                }
            }
            // Functions and training information are never written here.
            (20.., _) => return None,
            _ => {}
        }
    }
    let found = found.filter(|_| version == Some(IR_VERSION as u64))?;
    let mut values = Vec::with_capacity(RANGE_PARAMETERS);
    let takes_range = messages(found, 11).nth(1).is_some();
    for layer in layers(takes_range) {
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
    let tensor = messages(graph, 5).find(|tensor| messages(tensor, 8).eq([name.as_bytes()]))?;
    let raw = messages(tensor, 9).next().filter(|raw| raw.len() == 4 * length)?;
    let (numbers, _) = raw.as_chunks::<4>();
    Some(numbers.iter().map(|bytes| f32::from_le_bytes(*bytes)))
}

fn graph(weights: &Weights) -> Vec<u8> {
    let mut graph = Graph::default();
    context(&mut graph);
    pixels(&mut graph, weights.takes_range());
    constants(&mut graph, weights);
    graph.finish("fathom_style")
}

/// The context branch, upsampled to the size of the picture.
fn context(graph: &mut Graph) {
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
    convolution(graph, ENTER, ("pooled", "entered"), 1);
    graph.node("Relu", &["entered"], "quarter", &[]);
    convolution(graph, REDUCE, ("quarter", "reduced"), 2);
    graph.node("Relu", &["reduced"], "context0", &[]);
    for (index, [spread_a, mix_a, spread_b, mix_b]) in BLOCKS.into_iter().enumerate() {
        let name = |what: &str| format!("block{index}.{what}");
        let (before, after) = (format!("context{index}"), format!("context{}", index + 1));
        convolution(graph, spread_a, (&before, &name("spread_a")), 1);
        convolution(graph, mix_a, (&name("spread_a"), &name("mix_a")), 1);
        graph.node("Relu", &[&name("mix_a")], &name("relu"), &[]);
        convolution(graph, spread_b, (&name("relu"), &name("spread_b")), 1);
        convolution(graph, mix_b, (&name("spread_b"), &name("mix_b")), 1);
        graph.node("Add", &[&before, &name("mix_b")], &after, &[]);
    }
    convolution(graph, LEAVE, ("context2", "left"), 1);
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
}

/// The branch at full resolution, the color map, and their sum with the context.
fn pixels(graph: &mut Graph, takes_range: bool) {
    convolution(graph, PIXEL, ("image", "pixel"), 1);
    if takes_range {
        ranged(graph);
    }
    let (both, sum) = if takes_range {
        ("both.ranged", "sum.ranged")
    } else {
        ("both", "sum")
    };
    graph.node("Add", &["pixel", "resized"], "both", &[]);
    if takes_range {
        graph.node("Add", &["both", "pixel.ranged"], both, &[]);
    }
    graph.node("Relu", &[both], "features", &[]);
    convolution(graph, OUTPUT, ("features", "texture"), 1);
    convolution(graph, COLOR, ("image", "toned"), 1);
    graph.node("Add", &["toned", "texture"], "sum", &[]);
    if takes_range {
        graph.node("Add", &["sum", "toned.ranged"], sum, &[]);
    }
    graph.node("Clip", &[sum, "black", "white"], "styled", &[]);
}

/// Contribution of the range to the features and to the color map.
fn ranged(graph: &mut Graph) {
    graph.input("range", 1);
    graph.node("Mul", &["image", "range"], "image.ranged", &[]);
    let axis = Attribute::Integer(1);
    graph.node("Concat", &["image.ranged", "range"], "ranged", &[("axis", &axis)]);
    convolution(graph, RANGE_PIXEL, ("ranged", "pixel.ranged"), 1);
    convolution(graph, RANGE_COLOR, ("ranged", "toned.ranged"), 1);
}

fn constants(graph: &mut Graph, weights: &Weights) {
    for &layer in weights.layers() {
        let sides = [layer.outputs, layer.inputs, layer.side, layer.side].map(|side| side as i64);
        graph.floats(&format!("{}.weight", layer.name), &sides, weights.weight(layer));
        graph.floats(&format!("{}.bias", layer.name), &sides[..1], weights.bias(layer));
    }
    graph.integers("border", &[0, 0, 1, 1, 0, 0, 1, 1]);
    graph.integers("zero", &[0]);
    graph.integers("two", &[2]);
    graph.integers("four", &[4]);
    graph.floats("black", &[], &[0.0]);
    graph.floats("white", &[], &[1.0]);
}

fn convolution(graph: &mut Graph, layer: Layer, ports: (&str, &str), step: i64) {
    let form = ConvolutionShape {
        side: layer.side as i64,
        step,
        groups: if layer.inputs == 1 {
            layer.outputs as i64
        } else {
            1
        },
        padding: (layer.side == 3).then_some(("border", "edge")),
    };
    graph.convolution(layer.name, ports, form);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::net::layer::PARAMETERS;

    fn some() -> Weights {
        numbered(PARAMETERS)
    }

    fn numbered(count: usize) -> Weights {
        Weights::new((0..count).map(|i| (i as f32 * 0.37).fract() - 0.5).collect()).unwrap()
    }

    #[test]
    fn the_numbers_come_back_from_the_file_and_metadata_does_not_matter() {
        for metadata in [&[][..], &[("seed", "7"), ("photo", "none")]] {
            for count in [PARAMETERS, RANGE_PARAMETERS] {
                assert_eq!(read(&write(&numbered(count), metadata)).unwrap(), numbered(count));
            }
        }
    }

    #[test]
    fn a_file_that_differs_anywhere_in_its_graph_is_another_network() {
        let file = write(&some(), &[]);
        let replaced = |from: &[u8], to: &[u8]| {
            let index = file
                .windows(from.len())
                .position(|window| window == from)
                .unwrap();
            let mut file = file.clone();
            file[index..index + to.len()].copy_from_slice(to);
            read(&file)
        };
        assert_eq!(replaced(b"half_pixel", b"asymmetric"), None);
        assert_eq!(replaced(b"Clip", b"Floo"), None);
        assert_eq!(replaced(b"Relu", b"Sqrt"), None);
        let nan = f32::NAN.to_le_bytes();
        assert_eq!(replaced(&some().weight(REDUCE)[0].to_le_bytes(), &nan), None);
        assert_eq!(read(b""), None);
        assert_eq!(read(b"no model index all"), None);
        for end in [1, 100, file.len() / 2, file.len() - 1] {
            assert_eq!(read(&file[..end]), None, "{end}");
        }
    }
}
