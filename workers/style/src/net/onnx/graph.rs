//! Encodes ONNX graphs: nodes in order, then tensors, inputs and outputs, by field number.

use std::borrow::Cow;

use super::super::wire::{bytes, integer};

/// ONNX element types.
const FLOAT: i64 = 1;
const INT64: i64 = 7;

/// The value of an attribute.
pub enum Attribute<'a> {
    /// An integer.
    Integer(i64),
    /// Integers.
    Integers(&'a [i64]),
    /// Text.
    Text(&'a str),
}

/// A graph from `image` and optional further inputs to `styled`.
#[derive(Default)]
pub struct Graph {
    message: Vec<u8>,
    tensors: Vec<Vec<u8>>,
    inputs: Vec<Vec<u8>>,
}

impl Graph {
    /// Adds an operator with one output.
    pub fn node(
        &mut self,
        operator: &str,
        inputs: &[&str],
        output: &str,
        attributes: &[(&str, &Attribute<'_>)],
    ) {
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

    /// Adds a convolution after padding each side, by the edge or by reflection. Its tensors are NAME.weight and
    /// NAME.bias.
    pub fn convolution(&mut self, name: &str, ports: (&str, &str), form: ConvolutionShape) {
        let (input, output) = ports;
        let mut input = Cow::Borrowed(input);
        if let Some((border, mode)) = form.padding {
            let padded = format!("{name}.padded");
            let mode = Attribute::Text(mode);
            self.node("Pad", &[&input, border], &padded, &[("mode", &mode)]);
            input = Cow::Owned(padded);
        }
        let (weight, bias) = (format!("{name}.weight"), format!("{name}.bias"));
        self.node(
            "Conv",
            &[&input, &weight, &bias],
            output,
            &[
                ("group", &Attribute::Integer(form.groups)),
                ("kernel_shape", &Attribute::Integers(&[form.side, form.side])),
                ("strides", &Attribute::Integers(&[form.step, form.step])),
            ],
        );
    }

    /// Adds an input next to `image`.
    pub fn input(&mut self, name: &str, channels: i64) {
        self.inputs.push(port(name, channels));
    }

    /// Adds a tensor of floats.
    pub fn floats(&mut self, name: &str, sides: &[i64], values: &[f32]) {
        let raw: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.tensors.push(tensor(name, FLOAT, sides, &raw));
    }

    /// Adds a tensor of integers.
    pub fn integers(&mut self, name: &str, values: &[i64]) {
        let raw: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.tensors
            .push(tensor(name, INT64, &[values.len() as i64], &raw));
    }

    /// The encoded graph.
    #[must_use]
    pub fn finish(mut self, name: &str) -> Vec<u8> {
        let message = &mut self.message;
        bytes(message, 2, name.as_bytes());
        for tensor in &self.tensors {
            bytes(message, 5, tensor);
        }
        bytes(message, 11, &port("image", 3));
        for input in &self.inputs {
            bytes(message, 11, input);
        }
        bytes(message, 12, &port("styled", 3));
        self.message
    }
}

/// Parameters of a convolution.
#[derive(Clone, Copy)]
pub struct ConvolutionShape {
    /// Side of the kernel.
    pub side: i64,
    /// Stride.
    pub step: i64,
    /// Groups of channels.
    pub groups: i64,
    /// Name of the tensor with the borders, and the mode.
    pub padding: Option<(&'static str, &'static str)>,
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

/// An input or output: float32 of shape [n, channels, h, w].
fn port(name: &str, channels: i64) -> Vec<u8> {
    let mut shape = Vec::new();
    for side in ["n", "", "h", "w"] {
        let mut dimension = Vec::new();
        match side {
            "" => integer(&mut dimension, 1, channels),
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
