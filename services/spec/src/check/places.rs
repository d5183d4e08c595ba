//! Possible values of document fields.

use super::Place;
use crate::node::Node;

/// The possible values of a document field, each with its pointer.
pub(crate) fn places<'a>(document: &'a Node, name: &str) -> Vec<(String, &'a Node)> {
    document
        .get(name)
        .map(|node| node.alternatives(&format!("/{name}")))
        .unwrap_or_default()
}

/// The possible lists of a document field, each with its location.
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
