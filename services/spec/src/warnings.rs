//! What a user should know about a valid description.

use serde::Deserialize;
use serde_json::Value;

use crate::check::{is_traced, places};
use crate::node::{Law, LawNode, Node};
use crate::vocabulary::Vocabulary;
use crate::water::Optics;

/// The warnings of a checked description; `written` is what was submitted.
pub(crate) fn find(document: &Node, written: &Value, vocabulary: &Vocabulary) -> Vec<String> {
    let mut warnings = Vec::new();
    let waters = places(document, "water");
    let none_has = |name| waters.iter().all(|(_, water)| water.get(name).is_none());
    if written.get("alpha").is_some() && none_has("style") {
        warnings
            .push("`alpha` weights the style, but `water.style` is not given: it has no effect".to_owned());
    }
    if !is_traced(document) {
        if written.get("truth").is_some() {
            warnings.push("`truth` has no effect without the artifact `truth` or `truth_report`".to_owned());
        }
    }
    let without_optics = ["range_scale", "depth_m", "holes", "turbidity"];
    for name in without_optics.into_iter().filter(|_| none_has("optics")) {
        if written.pointer(&format!("/water/{name}")).is_some() {
            warnings.push(format!("`water.{name}` has no effect without `water.optics`"));
        }
    }
    warnings.extend(waters.iter().filter_map(|(_, water)| optics(water, vocabulary)));
    let brings_picture = |scene: &Node| scene.get("family").is_none();
    if places(document, "scene")
        .iter()
        .all(|(_, scene)| brings_picture(scene))
    {
        for side in ["width", "height"] {
            if written.pointer(&format!("/camera/{side}")).is_some() {
                warnings.push(format!(
                    "`camera.{side}` has no effect: the scene brings its own size"
                ));
            }
        }
    }
    let values = document.laws().into_iter().flat_map(|law| law.values());
    if let Some(axis) = values.flat_map(Node::laws).find(|law| is_axis(law)) {
        warnings.push(format!(
            "the grid at {} multiplies the frames even where its place is not chosen",
            axis.pointer
        ));
    }
    warnings
}

/// What the rules of waters say of one of these optics.
fn optics(water: &Node, vocabulary: &Vocabulary) -> Option<String> {
    let optics = water.get("optics")?.alternatives("");
    optics.iter().find_map(|(_, optics)| {
        let numbers = Optics::deserialize(optics.value(&|law| law.draw(0))).ok()?;
        (vocabulary.rules.warning)(&numbers)
    })
}

/// Whether this law is a grid of more than one value.
fn is_axis(law: &LawNode) -> bool {
    matches!(law.law, Law::Grid { .. }) && law.values().len() > 1
}
