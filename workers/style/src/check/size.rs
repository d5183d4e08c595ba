//! Limits the nodes and tensors that an ONNX file declares, before ONNX Runtime allocates for them.

use prost::encoding::decode_varint;

use super::external::TensorMessage;
use super::unfit::Unfit;
use crate::net::wire::{WireValue, fields};

/// Nodes of all graphs and functions: the largest published networks for this purpose have some thousands, and ONNX Runtime needs
/// minutes to optimize 10^5.
const MAX_NODES: usize = 20_000;
/// Elements of all tensors together: an uploaded file has at most 64 MiB, and the smallest elements have four bits.
const MAX_ELEMENTS: u64 = 1 << 27;
/// Characters of a name in a message.
const NAME_CHARACTERS: usize = 80;

/// Checks a file without external tensors.
///
/// # Errors
/// [`Unfit::TooManyNodes`], [`Unfit::TooLarge`], or [`Unfit::NotOnnx`] for a malformed message.
pub(super) fn check_size(onnx: &[u8]) -> Result<(), Unfit> {
    Size::default().add(TensorMessage::Model, onnx)
}

/// The nodes and elements so far.
#[derive(Default)]
struct Size {
    nodes: usize,
    elements: u64,
}

impl Size {
    /// Adds a message; the depth of messages was limited by the search for external tensors.
    fn add(&mut self, kind: TensorMessage, bytes: &[u8]) -> Result<(), Unfit> {
        match kind {
            TensorMessage::Node => {
                self.nodes += 1;
                if self.nodes > MAX_NODES {
                    return Err(Unfit::TooManyNodes { most: MAX_NODES });
                }
            }
            TensorMessage::Tensor => return self.add_tensor(bytes, 1, 8),
            // Values and indices are tensors; the sides are those of the dense tensor.
            TensorMessage::Sparse => self.add_tensor(bytes, 3, u32::MAX)?,
            _ => {}
        }
        for field in fields(bytes) {
            match field.ok_or(Unfit::NotOnnx)? {
                (number, WireValue::Bytes(inner)) if kind.nested(number).is_some() => {
                    self.add(kind.nested(number).ok_or(Unfit::NotOnnx)?, inner)?;
                }
                (11..=13, WireValue::Bytes(value)) if kind == TensorMessage::Graph => {
                    self.add_value(value)?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Adds a tensor whose sides and name have these fields.
    fn add_tensor(&mut self, bytes: &[u8], sides_field: u32, name_field: u32) -> Result<(), Unfit> {
        let (mut name, mut sides) = (&[][..], Vec::new());
        for field in fields(bytes) {
            match field.ok_or(Unfit::NotOnnx)? {
                (number, WireValue::Integer(side)) if number == sides_field => sides.push(side),
                (number, WireValue::Bytes(packed)) if number == sides_field => {
                    sides.extend(unpack(packed).ok_or(Unfit::NotOnnx)?);
                }
                (number, WireValue::Bytes(text)) if number == name_field => name = text,
                _ => {}
            }
        }
        let elements = product(&sides);
        self.elements = self.elements.saturating_add(elements);
        if self.elements > MAX_ELEMENTS {
            return Err(too_large(name, sides));
        }
        Ok(())
    }

    /// Checks the declared shape of an input, output or intermediate value: type, tensor, shape, side.
    fn add_value(&self, value: &[u8]) -> Result<(), Unfit> {
        let (mut name, mut sides) = (&[][..], Vec::new());
        for field in fields(value) {
            match field.ok_or(Unfit::NotOnnx)? {
                (1, WireValue::Bytes(text)) => name = text,
                (2, WireValue::Bytes(kind)) => collect_sides(kind, &[1, 2, 1], &mut sides)?,
                _ => {}
            }
        }
        if product(&sides) > MAX_ELEMENTS {
            return Err(too_large(name, sides));
        }
        Ok(())
    }
}

/// The fixed sides at the end of a path of fields. Negative ones count as variable, as some exporters write them.
fn collect_sides(bytes: &[u8], path: &[u32], sides: &mut Vec<u64>) -> Result<(), Unfit> {
    for field in fields(bytes) {
        match (field.ok_or(Unfit::NotOnnx)?, path) {
            ((1, WireValue::Integer(side)), []) if i64::try_from(side).is_ok() => sides.push(side),
            ((number, WireValue::Bytes(inner)), [first, rest @ ..]) if number == *first => {
                collect_sides(inner, rest, sides)?;
            }
            _ => {}
        }
    }
    Ok(())
}

fn product(sides: &[u64]) -> u64 {
    // A side of 0 must not hide others that overflow.
    sides
        .iter()
        .fold(1, |product: u64, side| product.saturating_mul((*side).max(1)))
}

fn unpack(mut packed: &[u8]) -> Option<Vec<u64>> {
    let mut values = Vec::new();
    while !packed.is_empty() {
        values.push(decode_varint(&mut packed).ok()?);
    }
    Some(values)
}

fn too_large(name: &[u8], sides: Vec<u64>) -> Unfit {
    Unfit::TooLarge {
        tensor: String::from_utf8_lossy(name)
            .chars()
            .take(NAME_CHARACTERS)
            .collect(),
        sides: sides.into_iter().take(8).collect(),
        most: MAX_ELEMENTS,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::net::wire::{bytes, integer};

    fn nest(path: &[u32], inner: &[u8]) -> Vec<u8> {
        path.iter().rev().fold(inner.to_vec(), |inner, &field| {
            let mut outer = Vec::new();
            bytes(&mut outer, field, &inner);
            outer
        })
    }

    fn tensor(sides: &[i64]) -> Vec<u8> {
        let mut tensor = Vec::new();
        sides.iter().for_each(|side| integer(&mut tensor, 1, *side));
        bytes(&mut tensor, 8, b"weights");
        tensor
    }

    #[test]
    fn a_tensor_of_too_many_elements_is_found_wherever_it_is_declared() {
        let mut packed = Vec::new();
        bytes(
            &mut packed,
            1,
            &[0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x10],
        );
        let sparse = |side: i64| {
            let mut sparse = Vec::new();
            integer(&mut sparse, 3, side);
            sparse
        };
        let value = |side: i64| {
            let mut dimension = Vec::new();
            integer(&mut dimension, 1, side);
            nest(&[2, 1, 2, 1], &dimension)
        };
        let large = [
            nest(&[7, 5], &tensor(&[1 << 60])),
            nest(&[7, 5], &tensor(&[1 << 31, 1 << 31, 4])),
            nest(&[7, 5], &tensor(&[0, i64::MAX, i64::MAX])),
            nest(&[7, 5], &tensor(&[-1])),
            nest(&[7, 5], &packed),
            nest(&[7, 1, 5, 5], &tensor(&[1 << 28])),
            nest(&[7, 15], &sparse(1 << 60)),
            nest(&[25, 7, 5, 6, 5], &tensor(&[1 << 60])),
            nest(&[7, 12], &value(1 << 60)),
            nest(&[7, 13], &value(1 << 60)),
            [0; 3].map(|_| nest(&[7, 5], &tensor(&[1 << 26]))).concat(),
        ];
        for model in large {
            assert!(
                matches!(check_size(&model), Err(Unfit::TooLarge { .. })),
                "{model:?}"
            );
        }
        for model in [
            nest(&[7, 5], &tensor(&[1 << 20])),
            nest(&[7, 5], &tensor(&[])),
            nest(&[7, 11], &value(-1)),
            nest(&[7, 15], &sparse(1000)),
        ] {
            assert!(check_size(&model).is_ok(), "{model:?}");
        }
    }

    #[test]
    fn nodes_are_counted_in_every_graph_and_function() {
        for path in [&[7, 1][..], &[7, 1, 5, 6, 1], &[25, 7], &[20, 2, 1]] {
            let many = |nodes: usize| nest(path, b"").repeat(nodes);
            assert!(check_size(&many(MAX_NODES / 2)).is_ok(), "{path:?}");
            assert!(
                matches!(check_size(&many(MAX_NODES + 1)), Err(Unfit::TooManyNodes { .. })),
                "{path:?}"
            );
        }
    }

    #[test]
    fn shipped_networks_are_far_below_the_limits() {
        let library = crate::Library::embedded().unwrap();
        for name in ["atlantic", "atlantic-range", "mediterranean", "muddy"] {
            let mut size = Size::default();
            size.add(TensorMessage::Model, &library.get(name).unwrap().onnx)
                .unwrap();
            assert!(
                size.nodes < 200 && size.elements < 1 << 20,
                "{name}: {}",
                size.nodes
            );
        }
    }
}
