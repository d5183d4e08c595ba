//! Hill climbing: from the random frames that came closest to their bounds, a few numbers are turned at a time, and what comes
//! closer is kept.

use imaging::random::Stream;

use super::{Outcome, Studio};

/// Most numbers that are turned in one step.
const MOST_TURNS: f64 = 4.0;
/// How far a number is turned in half of all cases; in the others it is drawn again.
const NEAR: f64 = 0.1;

/// A search that is still to run.
#[derive(Debug, Clone, PartialEq)]
pub struct Climb {
    start: Outcome,
}

/// Searches from the frames with the largest share of their bounds, one kind of frames after the other.
#[must_use]
pub fn starts(outcomes: &[Outcome], count: usize) -> Vec<Climb> {
    let mut kinds: Vec<&'static str> = outcomes.iter().map(|outcome| outcome.origin.kind()).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let mut best: Vec<(usize, &Outcome)> = Vec::new();
    for kind in kinds {
        let mut own: Vec<&Outcome> = outcomes
            .iter()
            .filter(|outcome| outcome.origin.kind() == kind)
            .collect();
        own.sort_by(|a, b| b.ratio().total_cmp(&a.ratio()));
        best.extend(own.into_iter().take(count).enumerate());
    }
    best.sort_by_key(|(rank, _)| *rank);
    let best = best.into_iter().take(count);
    best.map(|(_, start)| Climb { start: start.clone() }).collect()
}

impl Climb {
    /// Renders this many frames, each a step from the best so far: a function of the start.
    #[must_use]
    pub fn run(&self, studio: &mut Studio, frames: usize) -> Vec<Outcome> {
        let stream = Stream::stage(self.start.origin.setting.seed, "climb");
        let mut best = self.start.clone();
        let mut found = Vec::new();
        for step in 0..frames as u64 {
            let names = best.origin.names();
            let mut origin = best.origin.clone();
            let turns = 1 + (MOST_TURNS * stream.unit(step, 0)) as u64;
            for turn in 0..turns {
                let draw = |what: u64| stream.unit(step, 1 + 4 * turn + what);
                let name = &names[(draw(0) * names.len() as f64) as usize];
                let value = if draw(1) < 0.5 {
                    let before = super::Knobs::new(&origin.setting).unit(name);
                    (before + NEAR * (2.0 * draw(2) - 1.0)).clamp(0.0, 1.0)
                } else {
                    draw(2)
                };
                origin.setting.turned.insert(name.clone(), value);
            }
            let Some(outcome) = origin.run(studio) else {
                continue;
            };
            if outcome.ratio() > best.ratio() {
                best = outcome.clone();
            }
            found.push(outcome);
        }
        found
    }
}
