//! The rules of waters, tried for the possible values of the distributions.

use serde::Deserialize;

use crate::check::{Checker, find_values, has_lamps, has_procedural_scene, is_traced};
use crate::daylight::Daylight;
use crate::node::Node;
use crate::rules::WaterConditions;
use crate::water::Water;

impl Checker<'_> {
    /// Tries the water under each kind of daylight.
    pub(crate) fn try_waters(&mut self, document: &Node, frames: u64) {
        let Some(water) = document.get("water") else {
            return;
        };
        let alternatives = water.alternatives("");
        let is_empty = alternatives
            .iter()
            .all(|(_, water)| water.get("optics").or(water.get("snow")).is_none());
        if is_empty {
            return;
        }
        let (lamps, traced, solid) = (
            has_lamps(document),
            is_traced(document),
            find_widest_view(document),
        );
        let conditions: Vec<_> = list_daylights(document)
            .into_iter()
            .map(|daylight| WaterConditions {
                lamps,
                daylight,
                traced,
                solid,
            })
            .collect();
        let find_faults = self.vocabulary.rules.faults;
        self.try_values("water", water, frames, &|water: &Water| {
            conditions
                .iter()
                .flat_map(|condition| find_faults(water, *condition))
                .collect()
        });
    }
}

/// The possible kinds of daylight; the rules do not depend on the numbers of a sky.
fn list_daylights(document: &Node) -> Vec<Daylight> {
    let alternatives = find_values(document, "daylight").into_iter();
    let mut all: Vec<_> = alternatives
        .filter_map(|(_, node): (String, &Node)| Daylight::deserialize(node.value(&|law| law.draw(0))).ok())
        .collect();
    all.dedup();
    all
}

/// Maximum of `W H / f²` over the possible cameras.
fn find_widest_view(document: &Node) -> Option<f64> {
    let cameras = find_values(document, "camera")
        .into_iter()
        .filter_map(|(_, camera)| {
            let hfov_deg = camera.get("hfov_deg").and_then(Node::greatest)?;
            let height = camera.get("height").and_then(Node::greatest)?;
            let width = camera.get("width").and_then(Node::least)?;
            let across = 2.0 * (0.5 * hfov_deg.to_radians()).tan();
            Some(across * across * height / width)
        });
    cameras
        .reduce(f64::max)
        .filter(|_| has_procedural_scene(document))
}
