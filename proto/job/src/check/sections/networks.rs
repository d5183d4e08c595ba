//! Networks of the user in a description.

use serde_json::Value;

use crate::check::{Checker, find_lists, find_values, has_procedural_scene};
use crate::enhancement::NETWORK_METHOD;
use crate::invalid::FieldError;
use crate::node::Node;
use crate::vocabulary::{KnownNetwork, METRIC_NETWORK};

impl Checker<'_> {
    /// Rejects networks of one size if a camera can have another. Uploaded pictures have other sizes, which are checked at
    /// rendering.
    pub(crate) fn check_network_sizes(&mut self, document: &Node) {
        if !has_procedural_scene(document) {
            return;
        }
        let vocabulary = self.vocabulary;
        for (pointer, name) in find_enhancers(document) {
            self.check_network_size(document, &pointer, name, &vocabulary.enhancers);
        }
        for (location, items) in find_lists(document, "metrics") {
            for (position, item) in items.iter().enumerate() {
                for (pointer, name) in item.strings(&location.item(position).pointer) {
                    if let Some(name) = name.strip_prefix(METRIC_NETWORK) {
                        self.check_network_size(document, &pointer, name, &vocabulary.metric_networks);
                    }
                }
            }
        }
    }

    fn check_network_size(&mut self, document: &Node, pointer: &str, name: &str, networks: &[KnownNetwork]) {
        let known = networks.iter().find(|network| network.name == name);
        let Some([width, height]) = known.and_then(|network| network.size) else {
            return;
        };
        for (_, camera) in find_values(document, "camera") {
            let differing = [("width", width), ("height", height)].into_iter();
            let differing = differing.filter_map(|(field, own)| {
                let sides = [camera.get(field)?.least()?, camera.get(field)?.greatest()?];
                let other = sides.into_iter().find(|side| *side != own as f64)?;
                Some(format!("`camera.{field}` can be {other}"))
            });
            let differing: Vec<_> = differing.collect();
            if differing.is_empty() {
                continue;
            }
            let message = format!(
                "the network \"{name}\" takes pictures of {width}×{height} only, but {}: set the camera to {width}×{height}, or use a \
                 network for any size",
                differing.join(" and ")
            );
            self.refuse(|| {
                FieldError::new(pointer, message)
                    .value(&Value::from(name))
                    .limit(format!("only with pictures of {width}×{height}"))
            });
        }
    }
}

/// Every enhancer network that a frame can use, with its pointer.
pub(crate) fn find_enhancers(document: &Node) -> Vec<(String, &str)> {
    let mut found = Vec::new();
    for (location, items) in find_lists(document, "enhance") {
        for (position, item) in items.iter().enumerate() {
            for (pointer, enhancement) in item.alternatives(&location.item(position).pointer) {
                found.extend(find_models(enhancement, &pointer));
                found.extend(find_in_steps(enhancement, &pointer));
            }
        }
    }
    found
}

/// The networks of the steps of a chain.
fn find_in_steps<'a>(enhancement: &'a Node, pointer: &str) -> Vec<(String, &'a str)> {
    let mut found = Vec::new();
    let lists = enhancement.get("steps").into_iter();
    for (pointer, list) in lists.flat_map(|steps| steps.alternatives(&format!("{pointer}/steps"))) {
        let Node::List(steps) = list else { continue };
        for (position, step) in steps.iter().enumerate() {
            for (pointer, step) in step.alternatives(&format!("{pointer}/{position}")) {
                let Some(network) = step.get(NETWORK_METHOD) else {
                    continue;
                };
                for (pointer, network) in network.alternatives(&format!("{pointer}/{NETWORK_METHOD}")) {
                    found.extend(find_models(network, &pointer));
                }
            }
        }
    }
    found
}

fn find_models<'a>(network: &'a Node, pointer: &str) -> Vec<(String, &'a str)> {
    let model = network.get("model");
    model.map_or_else(Vec::new, |model| model.strings(&format!("{pointer}/model")))
}
