//! Possible values of document fields.

use super::Location;
use crate::node::Node;

/// The possible values of a document field, each with its pointer.
pub(crate) fn find_values<'a>(document: &'a Node, name: &str) -> Vec<(String, &'a Node)> {
    document
        .get(name)
        .map(|node| node.alternatives(&format!("/{name}")))
        .unwrap_or_default()
}

/// The possible lists of a document field, each with its location.
pub(crate) fn find_lists<'a>(document: &'a Node, name: &str) -> Vec<(Location, &'a [Node])> {
    let mut lists = Vec::new();
    for (pointer, node) in find_values(document, name) {
        if let Node::List(items) = node {
            let name = name.to_owned();
            lists.push((Location { pointer, name }, items.as_slice()));
        }
    }
    lists
}
