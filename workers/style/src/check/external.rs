//! Rejects external tensors in ONNX files: an uploaded model could read arbitrary paths through them.

use super::unfit::Unfit;
use crate::net::wire::{WireValue, fields};

/// Limit on nested graphs (loops and branches); real models have three.
const MAX_DEPTH: usize = 64;

/// ONNX messages that can contain a tensor.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum TensorMessage {
    Model,
    Training,
    Graph,
    Function,
    Node,
    Attribute,
    Sparse,
    Tensor,
}

impl TensorMessage {
    /// The message type of a field, if it can contain a tensor.
    pub(super) fn nested(self, field: u32) -> Option<Self> {
        Some(match (self, field) {
            (Self::Model, 7) | (Self::Training, 1 | 2) | (Self::Attribute, 6 | 11) => Self::Graph,
            (Self::Model, 20) => Self::Training,
            (Self::Model, 25) => Self::Function,
            (Self::Graph, 1) | (Self::Function, 7) => Self::Node,
            (Self::Node, 5) | (Self::Function, 11) => Self::Attribute,
            (Self::Graph, 15) | (Self::Attribute, 22 | 23) => Self::Sparse,
            (Self::Graph, 5) | (Self::Attribute, 5 | 10) | (Self::Sparse, 1 | 2) => Self::Tensor,
            _ => return None,
        })
    }
}

/// Searches a file for external tensors.
///
/// # Errors
/// [`Unfit::NotOnnx`] or [`Unfit::External`], the first found.
pub(super) fn find_external(onnx: &[u8]) -> Result<(), Unfit> {
    let has_graph = fields(onnx).any(|field| matches!(field, Some((7, WireValue::Bytes(_)))));
    if !has_graph {
        return Err(Unfit::NotOnnx);
    }
    message(TensorMessage::Model, onnx, MAX_DEPTH)
}

fn message(kind: TensorMessage, bytes: &[u8], depth: usize) -> Result<(), Unfit> {
    if kind == TensorMessage::Tensor {
        return tensor(bytes);
    }
    let depth = depth.checked_sub(1).ok_or(Unfit::NotOnnx)?;
    for field in fields(bytes) {
        let (number, value) = field.ok_or(Unfit::NotOnnx)?;
        if let (Some(below), WireValue::Bytes(inner)) = (kind.nested(number), value) {
            message(below, inner, depth)?;
        }
    }
    Ok(())
}

fn tensor(bytes: &[u8]) -> Result<(), Unfit> {
    let (mut name, mut external) = (String::new(), false);
    for field in fields(bytes) {
        match field.ok_or(Unfit::NotOnnx)? {
            (8, WireValue::Bytes(text)) => name = String::from_utf8_lossy(text).into_owned(),
            (13, _) => external = true,
            (14, WireValue::Integer(location)) => external |= location != 0,
            _ => {}
        }
    }
    if external {
        Err(Unfit::External { tensor: name })
    } else {
        Ok(())
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

    #[test]
    fn a_tensor_in_another_file_is_found_wherever_a_tensor_can_stand() {
        let mut elsewhere = Vec::new();
        bytes(&mut elsewhere, 8, b"weights");
        integer(&mut elsewhere, 14, 1);
        let mut named = Vec::new();
        bytes(&mut named, 8, b"weights");
        bytes(&mut named, 13, b"location");
        let places: [&[u32]; 9] = [
            &[7, 5],
            &[7, 1, 5, 5],
            &[7, 1, 5, 10],
            &[7, 15, 2],
            &[7, 1, 5, 6, 5],
            &[7, 1, 5, 11, 1, 5, 22, 1],
            &[20, 2, 5],
            &[25, 7, 5, 5],
            &[25, 11, 5],
        ];
        for place in places {
            for tensor in [&elsewhere, &named] {
                let mut model = nest(&[7, 2], b"graph");
                model.extend(nest(place, tensor));
                assert!(
                    matches!(find_external(&model), Err(Unfit::External { tensor }) if tensor == "weights"),
                    "{place:?}"
                );
            }
            let mut model = nest(&[7, 2], b"graph");
            model.extend(nest(place, &nest(&[8], b"weights")));
            assert!(find_external(&model).is_ok(), "{place:?}");
        }
    }

    #[test]
    fn what_is_no_onnx_file_or_too_deep_is_told_apart() {
        for file in [&b""[..], b"hello, world", &[0xff; 40]] {
            assert!(matches!(find_external(file), Err(Unfit::NotOnnx)));
        }
        let mut path = vec![7];
        path.extend([1, 5, 6].repeat(40));
        assert!(matches!(find_external(&nest(&path, b"")), Err(Unfit::NotOnnx)));
        for model in ["atlantic", "atlantic-range", "mediterranean", "muddy"] {
            let library = crate::Library::embedded().unwrap();
            assert!(
                find_external(&library.get(model).unwrap().onnx).is_ok(),
                "{model}"
            );
        }
    }
}
