//! Warnings about a valid description.

use serde::Deserialize;

use crate::check::{find_black_frames, find_values};
use crate::node::{Law, LawNode, Node};
use crate::vocabulary::Vocabulary;
use crate::water::Optics;

pub(crate) fn find(document: &Node, vocabulary: &Vocabulary) -> Vec<String> {
    let waters = find_values(document, "water");
    let mut warnings: Vec<_> = waters
        .iter()
        .filter_map(|(_, water)| optics(water, vocabulary))
        .collect();
    warnings.extend(find_black_frames(document));
    let values = document.laws().into_iter().flat_map(|law| law.values());
    if let Some(axis) = values.flat_map(Node::laws).find(|law| is_axis(law)) {
        warnings.push(format!(
            "the grid at {} multiplies the frames even if its choice is not drawn",
            axis.pointer
        ));
    }
    warnings
}

/// The warning of the water rules for one of the possible optics.
fn optics(water: &Node, vocabulary: &Vocabulary) -> Option<String> {
    let optics = water.get("optics")?.alternatives("");
    optics.iter().find_map(|(_, optics)| {
        let numbers = Optics::deserialize(optics.value(&|law| law.draw(0))).ok()?;
        (vocabulary.rules.warning)(&numbers)
    })
}

/// Whether this distribution is a grid of more than one value.
fn is_axis(law: &LawNode) -> bool {
    matches!(law.law, Law::Grid { .. }) && law.values().len() > 1
}
