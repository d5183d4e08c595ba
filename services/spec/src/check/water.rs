//! The rules of waters, tried for the possible values of the distributions.

use serde::Deserialize;

use super::{Checker, has_lamps, is_traced, places};
use crate::daylight::Daylight;
use crate::node::Node;
use crate::rules::Sight;
use crate::water::Water;

impl Checker<'_> {
    /// Tries the water under each kind of daylight.
    pub(crate) fn water(&mut self, document: &Node, frames: u64) {
        let Some(water) = document.get("water") else {
            return;
        };
        let alternatives = water.alternatives("");
        let has = |name| alternatives.iter().any(|(_, water)| water.get(name).is_some());
        if !(has("optics") || has("snow")) {
            return;
        }
        let (lamps, traced, solid) = (has_lamps(document), is_traced(document), widest(document));
        let sights: Vec<_> = daylights(document)
            .into_iter()
            .map(|daylight| Sight {
                lamps,
                daylight,
                traced,
                solid,
            })
            .collect();
        let find_faults = self.vocabulary.rules.faults;
        self.try_values("water", water, frames, &|water: &Water| {
            sights
                .iter()
                .flat_map(|sight| find_faults(water, *sight))
                .collect()
        });
    }
}

/// The possible kinds of daylight; the rules do not depend on the numbers of a sky.
fn daylights(document: &Node) -> Vec<Daylight> {
    let alternatives = places(document, "daylight").into_iter();
    let mut all: Vec<_> = alternatives
        .filter_map(|(_, node): (String, &Node)| Daylight::deserialize(node.value(&|law| law.draw(0))).ok())
        .collect();
    all.dedup();
    all
}

/// Maximum of `W H / f²` over the possible cameras.
fn widest(document: &Node) -> Option<f64> {
    let cameras = places(document, "camera").into_iter().filter_map(|(_, camera)| {
        let most = |name| camera.get(name).and_then(Node::greatest);
        let across = 2.0 * (0.5 * most("hfov_deg")?.to_radians()).tan();
        Some(across * across * most("height")? / camera.get("width").and_then(Node::least)?)
    });
    cameras.reduce(f64::max).filter(|_| {
        places(document, "scene")
            .iter()
            .any(|(_, scene): &(String, &Node)| scene.get("family").is_some())
    })
}
