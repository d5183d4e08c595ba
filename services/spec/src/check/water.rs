//! What must fit together within the water: the rules of waters, asked for those that the laws can yield.

use std::collections::BTreeSet;

use serde::Deserialize;

use super::Checker;
use super::{has_lamps, places};
use crate::invalid::FieldError;
use crate::node::{Drawn, LawNode, Node};
use crate::rules::Sight;
use crate::water::Water;

/// This many frames from the first on are tried as they are.
const FRAMES_TRIED: u64 = 64;

/// At most this many combinations of extremes are tried: 12 intervals, or 100 presets by 5 intervals. Beyond it each
/// law's extremes are tried alone, against all others at their lower and at their upper end.
const EXTREMES_TRIED: usize = 4096;

/// Which extreme each law takes.
#[derive(Default)]
struct Extremes<'a> {
    /// What those take that are not named below: their last extreme or their first.
    last: bool,
    /// By the law's pointer.
    named: Vec<(&'a str, usize)>,
}

impl Extremes<'_> {
    fn draw(&self, law: &LawNode) -> Drawn {
        let named = self
            .named
            .iter()
            .find(|(pointer, _)| *pointer == law.pointer)
            .map(|(_, position)| *position);
        law.extreme(named.unwrap_or(if self.last { law.extreme_count() - 1 } else { 0 }))
    }
}

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
        let sight = Sight {
            lamps: has_lamps(document),
            solid: widest(document),
        };
        let mut found = BTreeSet::new();
        for extremes in extremes(water) {
            self.try_water(water, sight, &|law: &LawNode| extremes.draw(law), &mut found);
        }
        let tried = if water.laws().is_empty() {
            0
        } else {
            frames.min(FRAMES_TRIED)
        };
        for frame in 0..tried {
            self.try_water(water, sight, &|law: &LawNode| law.draw(frame), &mut found);
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
                    "a water that the laws can yield: "
                };
                self.refuse(|| FieldError::new(&pointer, format!("{varied}{}", fault.message)));
            }
        }
    }
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

/// Combinations of the laws' extremes; one if there is no law.
fn extremes(water: &Node) -> Vec<Extremes<'_>> {
    let mut laws = water.laws();
    laws.retain(|law| law.extreme_count() > 1);
    let product = laws
        .iter()
        .try_fold(1_usize, |product, law| product.checked_mul(law.extreme_count()));
    if product.is_none_or(|product| product > EXTREMES_TRIED) {
        return one_at_a_time(&laws);
    }
    laws.iter().fold(vec![Extremes::default()], |combinations, law| {
        let mut wider = Vec::with_capacity(combinations.len() * law.extreme_count());
        for combination in &combinations {
            wider.extend((0..law.extreme_count()).map(|position| {
                let named = combination
                    .named
                    .iter()
                    .copied()
                    .chain([(law.pointer.as_str(), position)]);
                Extremes {
                    last: false,
                    named: named.collect(),
                }
            }));
        }
        wider
    })
}

fn one_at_a_time<'a>(laws: &[&'a LawNode]) -> Vec<Extremes<'a>> {
    let mut combinations = Vec::new();
    for law in laws {
        let way = way_to(&law.pointer, laws);
        for (last, position) in
            (0..law.extreme_count()).flat_map(|position| [(false, position), (true, position)])
        {
            if combinations.len() == EXTREMES_TRIED {
                return combinations;
            }
            let named = way
                .iter()
                .copied()
                .chain([(law.pointer.as_str(), position)])
                .collect();
            combinations.push(Extremes { last, named });
        }
    }
    combinations
}

/// What the choices and grids around a law must choose for it to come into play.
fn way_to<'a>(pointer: &str, laws: &[&'a LawNode]) -> Vec<(&'a str, usize)> {
    let chosen = |outer: &&'a LawNode| {
        let inside = pointer.strip_prefix(outer.pointer.as_str())?.strip_prefix('/')?;
        let position = inside
            .strip_prefix(outer.key())?
            .split('/')
            .nth(1)?
            .parse()
            .ok()?;
        Some((outer.pointer.as_str(), position))
    };
    laws.iter().filter_map(chosen).collect()
}
