//! Hand-written ONNX files, with the subset of the format needed to test hostile models.

/// An encoded message under construction.
#[derive(Default, Clone)]
pub struct Message(Vec<u8>);

impl Message {
    /// Adds bytes, a text or another message under a field.
    #[must_use]
    pub fn bytes(mut self, field: u64, bytes: impl AsRef<[u8]>) -> Self {
        self.varint(field << 3 | 2);
        self.varint(bytes.as_ref().len() as u64);
        self.0.extend_from_slice(bytes.as_ref());
        self
    }

    /// Adds an integer under a field.
    #[must_use]
    pub fn number(mut self, field: u64, value: u64) -> Self {
        self.varint(field << 3);
        self.varint(value);
        self
    }

    fn varint(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.0.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.0.push(value as u8);
    }
}

impl AsRef<[u8]> for Message {
    fn as_ref(&self) -> &[u8] {
        &self.0
    }
}

const FLOAT: u64 = 1;
const INT64: u64 = 7;
const BOOL: u64 = 9;

/// A node: an operator, its inputs and its output.
#[must_use]
pub fn node(operator: &str, inputs: &[&str], outputs: &[&str]) -> Message {
    let node = inputs
        .iter()
        .fold(Message::default(), |node, input| node.bytes(1, input));
    let node = outputs.iter().fold(node, |node, output| node.bytes(2, output));
    node.bytes(4, operator)
}

/// An attribute with an integer.
#[must_use]
pub fn whole(name: &str, value: u64) -> Message {
    const INT: u64 = 2;
    Message::default().bytes(1, name).number(3, value).number(20, INT)
}

/// An attribute with a list of integers.
#[must_use]
pub fn numbers(name: &str, values: &[u64]) -> Message {
    const INTS: u64 = 7;
    let list = values
        .iter()
        .fold(Message::default().bytes(1, name), |list, &value| {
            list.number(8, value)
        });
    list.number(20, INTS)
}

/// An attribute with a graph.
#[must_use]
pub fn body(name: &str, graph: &Message) -> Message {
    const GRAPH: u64 = 5;
    Message::default()
        .bytes(1, name)
        .bytes(6, graph)
        .number(20, GRAPH)
}

/// A constant integer, or a list of them.
#[must_use]
pub fn constant(name: &str, values: &[i64], is_list: bool) -> Message {
    let raw: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    let tensor = if is_list {
        Message::default().number(1, values.len() as u64)
    } else {
        Message::default()
    };
    tensor.number(2, INT64).bytes(8, name).bytes(9, raw)
}

/// A constant that is true.
#[must_use]
pub fn yes(name: &str) -> Message {
    Message::default().number(2, BOOL).bytes(8, name).bytes(9, [1])
}

/// A float constant whose bytes are in an external file.
#[must_use]
pub fn elsewhere(name: &str, file: &str) -> Message {
    let location = Message::default().bytes(1, "location").bytes(2, file);
    let tensor = Message::default().number(1, 1).number(2, FLOAT).bytes(8, name);
    tensor.bytes(13, location).number(14, 1)
}

/// An input or output of a graph: float pictures with this many channels.
#[must_use]
pub fn picture(name: &str, channels: u64, sides: [&str; 2]) -> Message {
    let side = |text: &str| Message::default().bytes(2, text);
    let fixed = |number: u64| Message::default().number(1, number);
    let shape = Message::default()
        .bytes(1, fixed(1))
        .bytes(1, fixed(channels))
        .bytes(1, side(sides[0]))
        .bytes(1, side(sides[1]));
    typed(name, FLOAT, Some(shape))
}

/// An output of floats without a declared shape.
#[must_use]
pub fn floats(name: &str) -> Message {
    typed(name, FLOAT, None)
}

/// An input or output of a loop's graph: a counter or a condition.
#[must_use]
pub fn scalar(name: &str, is_condition: bool) -> Message {
    typed(
        name,
        if is_condition { BOOL } else { INT64 },
        Some(Message::default()),
    )
}

fn typed(name: &str, kind: u64, shape: Option<Message>) -> Message {
    let tensor = Message::default().number(1, kind);
    let tensor = shape.iter().fold(tensor, |tensor, shape| tensor.bytes(2, shape));
    Message::default()
        .bytes(1, name)
        .bytes(2, Message::default().bytes(1, tensor))
}

/// A graph of these nodes, constants, inputs and outputs.
#[must_use]
pub fn graph(nodes: &[Message], constants: &[Message], inputs: &[Message], outputs: &[Message]) -> Message {
    let parts = [(1, nodes), (5, constants), (11, inputs), (12, outputs)];
    let all = parts
        .iter()
        .flat_map(|(field, list)| list.iter().map(move |part| (*field, part)));
    all.fold(Message::default().bytes(2, "test"), |graph, (field, part)| {
        graph.bytes(field, part)
    })
}

/// The file of a graph.
#[must_use]
pub fn file(graph: &Message) -> Vec<u8> {
    let operators = Message::default().bytes(1, "").number(2, 17);
    Message::default()
        .number(1, 8)
        .bytes(7, graph)
        .bytes(8, operators)
        .0
}

/// The file of a graph from `image` to `styled`.
#[must_use]
pub fn from_image(nodes: &[Message], constants: &[Message]) -> Vec<u8> {
    let (image, styled) = (
        picture("image", 3, ["h", "w"]),
        picture("styled", 3, ["rows", "columns"]),
    );
    file(&graph(nodes, constants, &[image], &[styled]))
}
