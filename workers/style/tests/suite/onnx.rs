//! Hand-written ONNX files of one operator, with the necessary subset of protobuf.

/// float32 and float64 of ONNX's element types.
pub(crate) const FLOAT: u64 = 1;
pub(crate) const DOUBLE: u64 = 11;

/// A graph of one operator from all inputs to one output.
pub(crate) struct Graph<'a> {
    pub(crate) operator: &'a str,
    /// An integer attribute.
    pub(crate) attribute: Option<(&'a str, u64)>,
    /// Name, element type and channels of each input; all have shape [1, channels, h, w].
    pub(crate) inputs: &'a [(&'a str, u64, u64)],
    /// Inputs of the operator by position.
    pub(crate) operands: &'a [usize],
    pub(crate) output: &'a str,
}

impl Graph<'_> {
    /// The file.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        let mut node = Vec::new();
        for &operand in self.operands {
            node.extend(field(1, self.inputs[operand].0.as_bytes()));
        }
        node.extend(field(2, self.output.as_bytes()));
        node.extend(field(4, self.operator.as_bytes()));
        if let Some((name, value)) = self.attribute {
            const INT: u64 = 2;
            let attribute = [field(1, name.as_bytes()), number(3, value), number(20, INT)].concat();
            node.extend(field(5, &attribute));
        }
        let mut graph = [field(1, &node), field(2, b"test")].concat();
        for &(name, kind, channels) in self.inputs {
            let sides = [number(1, 1), number(1, channels), field(2, b"h"), field(2, b"w")];
            graph.extend(field(11, &value(name, kind, &sides)));
        }
        let sides = [
            number(1, 1),
            number(1, 3),
            field(2, b"rows"),
            field(2, b"columns"),
        ];
        graph.extend(field(12, &value(self.output, self.inputs[0].1, &sides)));
        let operators = [field(1, b""), number(2, 17)].concat();
        [number(1, 8), field(7, &graph), field(8, &operators)].concat()
    }
}

fn value(name: &str, kind: u64, sides: &[Vec<u8>]) -> Vec<u8> {
    let shape: Vec<u8> = sides.iter().flat_map(|side| field(1, side)).collect();
    let tensor = field(1, &[number(1, kind), field(2, &shape)].concat());
    [field(1, name.as_bytes()), field(2, &tensor)].concat()
}

fn field(number: u64, bytes: &[u8]) -> Vec<u8> {
    [
        varint(number << 3 | 2),
        varint(bytes.len() as u64),
        bytes.to_vec(),
    ]
    .concat()
}

fn number(number: u64, value: u64) -> Vec<u8> {
    [varint(number << 3), varint(value)].concat()
}

fn varint(mut value: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
    bytes
}

/// An attribute of an operator.
pub(crate) enum Attribute<'a> {
    Integer(&'a str, u64),
    Integers(&'a str, &'a [u64]),
}

/// A chain of operators on a picture, each with its attributes. An operator with two operands gets its input twice.
pub(crate) struct Chain<'a> {
    pub(crate) operators: &'a [(&'a str, usize, &'a [Attribute<'a>])],
    /// Shape of the picture, 0 for free sides.
    pub(crate) input: [u64; 4],
    /// Shape of the output; `None`: not declared.
    pub(crate) output: Option<&'a [u64]>,
    /// Inputs besides the picture.
    pub(crate) unused: &'a [&'a str],
}

impl Chain<'_> {
    /// The file.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        let mut graph = field(2, b"test");
        let last = self.operators.len();
        for (position, (operator, operands, attributes)) in self.operators.iter().enumerate() {
            let mut node = field(1, tensor_name(position, last).as_bytes()).repeat(*operands);
            node.extend(field(2, tensor_name(position + 1, last).as_bytes()));
            node.extend(field(4, operator.as_bytes()));
            for attribute in *attributes {
                node.extend(field(5, &attribute.bytes()));
            }
            graph.extend(field(1, &node));
        }
        graph.extend(field(11, &port("picture", Some(&self.input))));
        for unused in self.unused {
            graph.extend(field(11, &port(unused, Some(&self.input))));
        }
        graph.extend(field(12, &port("result", self.output)));
        let operators = [field(1, b""), number(2, 17)].concat();
        [number(1, 8), field(7, &graph), field(8, &operators)].concat()
    }
}

fn tensor_name(position: usize, last: usize) -> String {
    match position {
        0 => "picture".to_owned(),
        position if position == last => "result".to_owned(),
        position => format!("t{position}"),
    }
}

impl Attribute<'_> {
    fn bytes(&self) -> Vec<u8> {
        const INT: u64 = 2;
        const INTS: u64 = 7;
        match self {
            Self::Integer(name, value) => {
                [field(1, name.as_bytes()), number(3, *value), number(20, INT)].concat()
            }
            Self::Integers(name, values) => {
                let values: Vec<u8> = values.iter().flat_map(|&value| number(8, value)).collect();
                [field(1, name.as_bytes()), values, number(20, INTS)].concat()
            }
        }
    }
}

/// A float32 input or output.
fn port(name: &str, shape: Option<&[u64]>) -> Vec<u8> {
    let mut tensor = number(1, FLOAT);
    if let Some(shape) = shape {
        let sides = shape.iter().enumerate().flat_map(|(axis, &side)| {
            let side = match side {
                0 => field(2, format!("{name}{axis}").as_bytes()),
                side => number(1, side),
            };
            field(1, &side)
        });
        tensor.extend(field(2, &sides.collect::<Vec<u8>>()));
    }
    [field(1, name.as_bytes()), field(2, &field(1, &tensor))].concat()
}

/// A network with the same output for every input.
pub(crate) struct Fixed<'a> {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// R, G and B planes one after the other, rows from top to bottom.
    pub(crate) samples: &'a [f32],
}

impl Fixed<'_> {
    /// The file: the picture minus itself, plus the samples.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        let sides = [1, 3, self.height as u64, self.width as u64];
        let dims: Vec<u8> = sides.iter().flat_map(|&side| number(1, side)).collect();
        let raw: Vec<u8> = self
            .samples
            .iter()
            .flat_map(|sample| sample.to_le_bytes())
            .collect();
        let samples = [dims, number(2, FLOAT), field(8, b"samples"), field(9, &raw)].concat();
        let graph = [
            field(1, &operation("Sub", ["picture", "picture"], "zero")),
            field(1, &operation("Add", ["zero", "samples"], "result")),
            field(2, b"test"),
            field(5, &samples),
            field(11, &port("picture", Some(&[1, 3, 0, 0]))),
            field(12, &port("result", Some(&[1, 3, 0, 0]))),
        ]
        .concat();
        let operators = [field(1, b""), number(2, 17)].concat();
        [number(1, 8), field(7, &graph), field(8, &operators)].concat()
    }
}

/// A node of two operands.
fn operation(operator: &str, operands: [&str; 2], result: &str) -> Vec<u8> {
    let [first, second] = operands.map(|operand| field(1, operand.as_bytes()));
    [
        first,
        second,
        field(2, result.as_bytes()),
        field(4, operator.as_bytes()),
    ]
    .concat()
}
