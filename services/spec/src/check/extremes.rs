//! The values that the laws of a part of the description can yield, as far as they are tried.

use std::collections::BTreeSet;

use serde::de::DeserializeOwned;

use super::Checker;
use crate::invalid::FieldError;
use crate::node::{Drawn, LawNode, Node};
use crate::rules::Fault;

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
    /// Tries a top-level field at the extremes of its distributions and in the first of `frames` frames, unless it has errors
    /// already. Adds the first fault of each place and field.
    pub(super) fn try_values<T: DeserializeOwned>(
        &mut self,
        name: &str,
        node: &Node,
        frames: u64,
        find_faults: &dyn Fn(&T) -> Vec<Fault>,
    ) {
        let top = format!("/{name}");
        if self.errors.iter().any(|error| error.pointer.starts_with(&top)) {
            return;
        }
        let varied = if node.laws().is_empty() {
            String::new()
        } else {
            format!("a {name} that the distributions can yield: ")
        };
        let mut found = BTreeSet::new();
        each_draw(node, frames, &mut |draw| {
            let Ok(values) = T::deserialize(node.value(&draw)) else {
                return;
            };
            for fault in find_faults(&values) {
                let pointer = node.locate(&top, &fault.path, &draw);
                if found.insert((pointer.clone(), fault.path.last().copied())) {
                    self.refuse(|| FieldError::new(&pointer, format!("{varied}{}", fault.message)));
                }
            }
        });
    }
}

/// A way to draw laws.
type Draw<'d> = dyn Fn(&LawNode) -> Drawn + 'd;

/// Hands out ways to draw the laws of a part: at their extremes, then as the first of `frames` frames draw them.
fn each_draw(node: &Node, frames: u64, found: &mut dyn FnMut(&Draw<'_>)) {
    for extremes in extremes(node) {
        found(&|law: &LawNode| extremes.draw(law));
    }
    let tried = if node.laws().is_empty() {
        0
    } else {
        frames.min(FRAMES_TRIED)
    };
    for frame in 0..tried {
        found(&|law: &LawNode| law.draw(frame));
    }
}

/// Combinations of the laws' extremes; one if there is no law.
fn extremes(node: &Node) -> Vec<Extremes<'_>> {
    let mut laws = node.laws();
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
