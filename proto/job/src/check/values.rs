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

/// Whether a frame can have a procedural scene.
pub(crate) fn has_procedural_scene(document: &Node) -> bool {
    let scenes = find_values(document, "scene");
    scenes.iter().any(|(_, scene)| scene.get("family").is_some())
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
