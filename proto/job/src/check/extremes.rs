//! The values that the distributions of a part can yield, as far as they are tried.

use std::collections::BTreeSet;

use serde::de::DeserializeOwned;

use super::Checker;
use crate::invalid::FieldError;
use crate::node::{Drawn, LawNode, Node};
use crate::rules::Fault;

/// Number of frames tried as drawn.
const FRAMES_TRIED: u64 = 64;

/// Maximum number of tried combinations: 12 intervals, or 100 presets by 5 intervals. Above it, the extremes of each
/// distribution are tried separately, against the lower and the upper ends of all others.
const EXTREMES_TRIED: usize = 4096;

/// The extreme of each distribution.
#[derive(Default)]
struct Extremes<'a> {
    /// Extreme of the distributions not in `named`: the last or the first.
    last: bool,
    /// By pointer.
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
    /// Tries a top-level field without errors at the extremes of its distributions and in the first of `frames`
    /// frames. Adds the first fault of each location and field.
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
            format!("a possible {name} of the distributions: ")
        };
        let mut found = BTreeSet::new();
        try_draws(node, frames, &mut |draw| {
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

/// A drawing function.
type Draw<'d> = dyn Fn(&LawNode) -> Drawn + 'd;

/// Calls `found` with drawing functions for a part: at the extremes, then for the first of `frames` frames.
fn try_draws(node: &Node, frames: u64, found: &mut dyn FnMut(&Draw<'_>)) {
    for extremes in combine_extremes(node) {
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

/// Combinations of extremes; one without distributions.
fn combine_extremes(node: &Node) -> Vec<Extremes<'_>> {
    let mut laws = node.laws();
    laws.retain(|law| law.extreme_count() > 1);
    let product = laws
        .iter()
        .try_fold(1_usize, |product, law| product.checked_mul(law.extreme_count()));
    if product.is_none_or(|product| product > EXTREMES_TRIED) {
        return vary_one_by_one(&laws);
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

fn vary_one_by_one<'a>(laws: &[&'a LawNode]) -> Vec<Extremes<'a>> {
    let mut combinations = Vec::new();
    for law in laws {
        let enclosing = enclosing_choices(&law.pointer, laws);
        for (last, position) in
            (0..law.extreme_count()).flat_map(|position| [(false, position), (true, position)])
        {
            if combinations.len() == EXTREMES_TRIED {
                return combinations;
            }
            let named = enclosing
                .iter()
                .copied()
                .chain([(law.pointer.as_str(), position)])
                .collect();
            combinations.push(Extremes { last, named });
        }
    }
    combinations
}

/// The selections of the enclosing choices and grids that activate a distribution.
fn enclosing_choices<'a>(pointer: &str, laws: &[&'a LawNode]) -> Vec<(&'a str, usize)> {
    laws.iter()
        .filter_map(|outer: &&'a LawNode| {
            let inside = pointer.strip_prefix(outer.pointer.as_str())?.strip_prefix('/')?;
            let position = inside
                .strip_prefix(outer.key())?
                .split('/')
                .nth(1)?
                .parse()
                .ok()?;
            Some((outer.pointer.as_str(), position))
        })
        .collect()
}
