//! Figures of a campaign.

use super::cost::Cost;
use super::outcome::Outcome;
use crate::row;
use crate::statistics::{largest, quantile, sorted};
use crate::table::Table;

/// Errors below this are mostly rounding.
const ROUNDING: f64 = 3e-6;

/// Figures of a campaign, or of a subset of it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Summary {
    /// Frames with a bound.
    pub(super) frames: usize,
    /// Frames with an unbounded stage; excluded from the other figures.
    open: usize,
    /// 95 % quantile, over these frames, of the share of samples above the bound.
    open_above: f64,
    /// Errors above their bound.
    pub(super) broken: usize,
    /// Bounds above their tolerance without a reason in the plan.
    pub(super) silent: usize,
    /// The largest error over its bound.
    worst: f64,
    /// Median of bound over error, for errors above rounding.
    median: f64,
    /// Bounds above their tolerance with a reason in the plan.
    exceeding: usize,
    /// Largest difference of 8-bit codes with the fidelity `picture`.
    pub(super) picture_codes: u8,
    /// Costs of the channels of water over the cheapest sufficient plan, ascending.
    pub(super) excess: Vec<f64>,
    /// The same by wall-clock time, for whole frames.
    clock: Vec<f64>,
}

impl Summary {
    /// Computes the figures.
    pub(super) fn new<'a>(outcomes: impl IntoIterator<Item = &'a Outcome>) -> Self {
        let outcomes: Vec<&Outcome> = outcomes.into_iter().collect();
        let (open, closed): (Vec<&Outcome>, Vec<&Outcome>) = outcomes
            .iter()
            .partition(|outcome| outcome.measured.promise.is_open);
        let loud = closed.iter().filter(|outcome| outcome.measured.error > ROUNDING);
        let costs: Vec<Cost> = outcomes.iter().filter_map(|outcome| outcome.cost).collect();
        let codes = closed.iter().filter_map(|outcome| outcome.measured.picture_codes);
        let count =
            |is_counted: fn(&Outcome) -> bool| closed.iter().filter(|outcome| is_counted(outcome)).count();
        Self {
            frames: closed.len(),
            open: open.len(),
            open_above: quantile(&sorted(open.iter().map(|outcome| outcome.measured.above)), 0.95),
            broken: count(Outcome::is_broken),
            silent: count(Outcome::is_silent),
            worst: largest(closed.iter().map(|outcome| outcome.ratio())),
            median: quantile(&sorted(loud.map(|outcome| 1.0 / outcome.ratio())), 0.5),
            exceeding: count(|outcome| outcome.measured.promise.exceeds),
            picture_codes: codes.max().unwrap_or(0),
            excess: sorted(costs.iter().flat_map(Cost::excess)),
            clock: sorted(costs.iter().map(Cost::excess_ms)),
        }
    }
}

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

/// A row for each kind of frames and one for all; the cost of water if it was measured.
pub(super) fn tables(outcomes: &[Outcome]) -> Vec<Table> {
    let columns = [
        "frames",
        "number",
        "error / bound, largest",
        "bound / error, median",
        "above the bound",
        "above tolerance, with reason",
        "without reason",
        "without bound",
        "samples above in 95 % of these, %",
        "codes off with `picture`, most",
    ];
    let mut table = Table::new("bounds", columns);
    let all = Summary::new(outcomes);
    let parts = kinds(outcomes).into_iter().map(|kind| {
        let is_part = |outcome: &&Outcome| outcome.origin.kind() == kind;
        (kind, Summary::new(outcomes.iter().filter(is_part)))
    });
    for (kind, part) in parts.chain([("all", all.clone())]) {
        table.push(row![
            kind,
            part.frames,
            part.worst,
            part.median,
            part.broken,
            part.exceeding,
            part.silent,
            part.open,
            100.0 * part.open_above,
            part.picture_codes,
        ]);
    }
    let mut tables = vec![table];
    if !all.excess.is_empty() {
        let mut cost = Table::new(
            "cost of water over the cheapest sufficient plan",
            ["by", "median", "95 %", "largest"],
        );
        for (name, values) in [("kernels", &all.excess), ("time", &all.clock)] {
            let [median, high, most] = [0.5, 0.95, 1.0].map(|share| quantile(values, share));
            cost.push(row![name, median, high, most]);
        }
        tables.push(cost);
    }
    tables
}
