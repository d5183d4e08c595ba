//! Reads the inputs of a model file without ONNX Runtime.

use crate::net::wire::messages;

/// Whether a model has an input of this name besides its picture; false for a file that is not a model.
pub(crate) fn takes(onnx: &[u8], name: &str) -> bool {
    let graph = messages(onnx, 7).next().unwrap_or_default();
    // Old files list their weights among the inputs as well.
    let weights: Vec<&[u8]> = messages(graph, 5)
        .filter_map(|tensor| messages(tensor, 8).next())
        .collect();
    let inputs = messages(graph, 11).filter_map(|input| messages(input, 1).next());
    let inputs: Vec<&[u8]> = inputs.filter(|name| !weights.contains(name)).collect();
    inputs.len() > 1 && inputs.contains(&name.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::net::wire::bytes;

    fn model(inputs: &[&str], weights: &[&str]) -> Vec<u8> {
        let (mut model, mut graph) = (Vec::new(), Vec::new());
        for (names, field, name_field) in [(inputs, 11, 1), (weights, 5, 8)] {
            for name in names {
                let mut named = Vec::new();
                bytes(&mut named, name_field, name.as_bytes());
                bytes(&mut graph, field, &named);
            }
        }
        bytes(&mut model, 7, &graph);
        model
    }

    #[test]
    fn an_input_is_noise_by_its_name_beside_another_and_if_it_is_no_weight() {
        let takes_noise = |onnx: &[u8]| takes(onnx, "noise");
        let both = model(&["image", "range", "noise"], &[]);
        assert!(takes(&both, "range") && takes_noise(&both) && !takes(&both, "depth"));
        assert!(takes_noise(&model(&["image", "noise"], &["weight"])));
        assert!(takes_noise(&model(&["noise", "x"], &[])));
        for (inputs, weights) in [
            (&["image"][..], &[][..]),
            (&["noise"], &[]),
            (&["image", "noise"], &["noise"]),
            (&["image", "mask"], &["noise"]),
        ] {
            assert!(!takes_noise(&model(inputs, weights)), "{inputs:?} {weights:?}");
        }
        for file in [&b""[..], b"hello, world", &[0xff; 40]] {
            assert!(!takes_noise(file));
        }
    }
}
