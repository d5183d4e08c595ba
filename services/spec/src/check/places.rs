//! What can stand at the places of a document.

use super::Place;
use crate::node::Node;

/// What can stand in a field of the document, each with its pointer.
pub(crate) fn places<'a>(document: &'a Node, name: &str) -> Vec<(String, &'a Node)> {
    document
        .get(name)
        .map(|node| node.alternatives(&format!("/{name}")))
        .unwrap_or_default()
}

/// Every list that can stand in a field of the document, with its place.
pub(super) fn lists<'a>(document: &'a Node, name: &str) -> Vec<(Place, &'a [Node])> {
    let mut lists = Vec::new();
    for (pointer, node) in places(document, name) {
        if let Node::List(items) = node {
            let name = name.to_owned();
            lists.push((Place { pointer, name }, items.as_slice()));
        }
    }
    lists
}

/// Whether a list holds nothing but the constant 0.
pub(super) fn is_zero(list: &Node) -> bool {
    let nothing = |node: &Node| matches!(node, Node::Constant(value) if value.as_f64() == Some(0.0));
    matches!(list, Node::List(axis) if axis.iter().all(nothing))
}
