//! Hill climbing from the frames closest to their bounds: each step changes a few numbers and is kept if the ratio of error to bound
//! grows.

use imaging::random::Stream;

use super::knobs::Knobs;
use super::outcome::Outcome;
use super::summary::kinds;
use crate::studio::Studio;

/// Maximum numbers changed in one step.
const MOST_TURNS: f64 = 4.0;
/// Half of the changes are at most this large; the others redraw the number.
const NEAR: f64 = 0.1;

/// The starts of searches: the frames with the largest ratio of error to bound, the first of each kind, then the second.
pub(super) fn list_starts(outcomes: &[Outcome], count: usize) -> Vec<Outcome> {
    let mut kinds = kinds(outcomes);
    kinds.sort_unstable();
    let mut best: Vec<(usize, &Outcome)> = Vec::new();
    for kind in kinds {
        let outcomes = outcomes.iter();
        let mut same: Vec<&Outcome> = outcomes.filter(|outcome| outcome.origin.kind() == kind).collect();
        same.sort_by(|a, b| b.ratio().total_cmp(&a.ratio()));
        best.extend(same.into_iter().take(count).enumerate());
    }
    best.sort_by_key(|(rank, _)| *rank);
    best.into_iter()
        .take(count)
        .map(|(_, start)| start.clone())
        .collect()
}

/// Renders this many frames, each one step from the best so far. The result is a function of the start.
pub(super) fn climb(start: &Outcome, studio: &mut Studio, frames: usize) -> Vec<Outcome> {
    let stream = Stream::stage(start.origin.source.seed, "climb");
    let mut best = start.clone();
    let mut found = Vec::new();
    for step in 0..frames as u64 {
        let names = best.origin.names();
        let mut origin = best.origin.clone();
        let turns = 1 + (MOST_TURNS * stream.unit(step, 0)) as u64;
        for turn in 0..turns {
            let [name, kind, value] = [1, 2, 3].map(|draw| stream.unit(step, 4 * turn + draw));
            let name = &names[(name * names.len() as f64) as usize];
            let before = Knobs::new(&origin.source).unit(name);
            let near = (before + NEAR * (2.0 * value - 1.0)).clamp(0.0, 1.0);
            let value = if kind < 0.5 { near } else { value };
            origin.source.turned.insert(name.clone(), value);
        }
        let Some(outcome) = Outcome::measure(&origin, studio) else {
            continue;
        };
        if outcome.ratio() > best.ratio() {
            best = outcome.clone();
        }
        found.push(outcome);
    }
    found
}
