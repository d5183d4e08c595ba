//! Figures of a campaign.

use super::measured::PictureError;
use super::outcome::Outcome;
use crate::row;
use crate::statistics::{largest, quantile, sorted};
use crate::table::Table;

/// Errors below this are mostly rounding.
const ROUNDING: f64 = 3e-6;

/// Kinds of frames, in the order of the frames.
pub(super) fn kinds(outcomes: &[Outcome]) -> Vec<&'static str> {
    let mut kinds = Vec::new();
    for kind in outcomes.iter().map(|outcome| outcome.origin.kind()) {
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    kinds
}

/// A row for each kind of frames and one for all. Frames with an unbounded stage are counted separately.
pub(super) fn summarize(outcomes: &[Outcome]) -> Table {
    let columns = "frames;number;error / bound, largest;bound / error, median;above the bound;above tolerance, with reason;without reason;\
                   without bound;samples above in 95 % of these, %;codes off with `picture`, most;error / bound with `picture`, largest";
    let mut table = Table::new("bounds", columns.split(';'));
    for kind in kinds(outcomes).into_iter().chain(["all"]) {
        let part = outcomes.iter();
        let part = part.filter(|outcome| kind == "all" || outcome.origin.kind() == kind);
        let (open, closed): (Vec<&Outcome>, Vec<&Outcome>) =
            part.partition(|outcome| outcome.measured.promise.is_open);
        let loud = closed.iter().filter(|outcome| outcome.measured.error > ROUNDING);
        let pictures: Vec<PictureError> = (closed.iter())
            .filter_map(|outcome| outcome.measured.picture)
            .collect();
        table.push(row![
            kind,
            closed.len(),
            largest(closed.iter().map(|outcome| outcome.ratio())),
            quantile(&sorted(loud.map(|outcome| 1.0 / outcome.ratio())), 0.5),
            closed.iter().filter(|outcome| outcome.is_broken()).count(),
            closed
                .iter()
                .filter(|outcome| outcome.measured.promise.exceeds)
                .count(),
            closed.iter().filter(|outcome| outcome.is_silent()).count(),
            open.len(),
            100.0 * quantile(&sorted(open.iter().map(|outcome| outcome.measured.above)), 0.95),
            pictures.iter().map(|picture| picture.codes).max(),
            largest(pictures.iter().map(|picture| picture.ratio)),
        ]);
    }
    table
}
