//! What must fit together within the water: the rules of waters, asked for those that the laws can yield.

use std::collections::BTreeSet;

use serde::Deserialize;

use super::Checker;
use super::extremes::each_draw;
use super::{has_lamps, is_traced, places};
use crate::daylight::Daylight;
use crate::invalid::FieldError;
use crate::node::{Drawn, LawNode, Node};
use crate::rules::Sight;
use crate::water::Water;

impl Checker<'_> {
    /// Tries the water at the extremes of its laws and of the first of `frames` frames. Says nothing about a water
    /// that has errors already.
    pub(crate) fn water(&mut self, document: &Node, frames: u64) {
        let Some(water) = document.get("water") else {
            return;
        };
        let alternatives = water.alternatives("");
        let has = |name| alternatives.iter().any(|(_, water)| water.get(name).is_some());
        if !(has("optics") || has("snow"))
            || self
                .errors
                .iter()
                .any(|error| error.pointer.starts_with("/water"))
        {
            return;
        }
        let mut found = BTreeSet::new();
        for daylight in daylights(document) {
            let sight = Sight {
                lamps: has_lamps(document),
                daylight,
                traced: is_traced(document),
                solid: widest(document),
            };
            each_draw(water, frames, &mut |draw| {
                self.try_water(water, sight, &draw, &mut found)
            });
        }
    }

    /// Adds the errors of one water; of each place and field only the first.
    fn try_water(
        &mut self,
        water: &Node,
        sight: Sight,
        draw: &impl Fn(&LawNode) -> Drawn,
        found: &mut BTreeSet<(String, &'static str)>,
    ) {
        let Ok(values) = Water::deserialize(water.value(draw)) else {
            return;
        };
        for fault in (self.vocabulary.rules.faults)(&values, sight) {
            let pointer = water.locate("/water", &fault.path, draw);
            let field = fault.path.last().copied().unwrap_or_default();
            if found.insert((pointer.clone(), field)) {
                let varied = if water.laws().is_empty() {
                    ""
                } else {
                    "a water that the distributions can yield: "
                };
                self.refuse(|| FieldError::new(&pointer, format!("{varied}{}", fault.message)));
            }
        }
    }
}

/// The kinds of daylight that a frame can have; no rule depends on the numbers of a sky.
fn daylights(document: &Node) -> Vec<Daylight> {
    let alternatives = places(document, "daylight").into_iter();
    let daylight = |(_, node): (String, &Node)| Daylight::deserialize(node.value(&|law| law.draw(0))).ok();
    let mut all: Vec<_> = alternatives.filter_map(daylight).collect();
    all.dedup();
    all
}

/// `W H / f²` of the widest and highest camera that the laws can yield.
fn widest(document: &Node) -> Option<f64> {
    let own = |(_, scene): &(String, &Node)| scene.get("family").is_some();
    let cameras = places(document, "camera").into_iter().filter_map(|(_, camera)| {
        let most = |name| camera.get(name).and_then(Node::greatest);
        let across = 2.0 * (0.5 * most("hfov_deg")?.to_radians()).tan();
        Some(across * across * most("height")? / camera.get("width").and_then(Node::least)?)
    });
    cameras
        .reduce(f64::max)
        .filter(|_| places(document, "scene").iter().any(own))
}
