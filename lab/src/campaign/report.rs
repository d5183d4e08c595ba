//! Figures of a campaign, and their Markdown.

use std::fmt::Write as _;

use super::{Cost, Outcome};

/// Errors below this are mostly rounding.
const ROUNDING: f64 = 3e-6;
/// Maximum failures listed in a report, the worst of each kind.
const NAMED: usize = 20;

/// Figures of a campaign, or of a subset of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Frames with a bound.
    pub frames: usize,
    /// Frames with an unbounded stage; excluded from the other figures.
    pub open: usize,
    /// 95 % quantile, over these frames, of the share of samples above the bound.
    pub open_above: f64,
    /// Errors above their bound.
    pub broken: usize,
    /// Bounds above their tolerance without a reason in the plan.
    pub silent: usize,
    /// The largest error over its bound.
    pub worst: f64,
    /// Median of bound over error, for errors above rounding.
    pub median: f64,
    /// Bounds above their tolerance with a reason in the plan.
    pub exceeding: usize,
    /// Largest difference of 8-bit codes with the fidelity `picture`.
    pub picture_codes: u8,
    /// Median cost of a channel of water over the cheapest sufficient plan.
    pub excess_median: f64,
    /// 95 % quantile of that cost.
    pub excess_95: f64,
    /// The largest of these costs.
    pub excess_max: f64,
    /// Median of the same by wall-clock time, for whole frames.
    pub clock_median: f64,
    /// 95 % quantile by wall-clock time.
    pub clock_95: f64,
}

impl Summary {
    /// Computes the figures.
    #[must_use]
    pub fn new(outcomes: &[Outcome]) -> Self {
        let all: Vec<&Outcome> = outcomes.iter().collect();
        Self::from_part(&all)
    }

    fn from_part(outcomes: &[&Outcome]) -> Self {
        let (open, closed): (Vec<&Outcome>, Vec<&Outcome>) = outcomes
            .iter()
            .partition(|outcome| outcome.measured.promise.is_open);
        let loud = closed.iter().filter(|outcome| outcome.measured.error > ROUNDING);
        let ratios = sorted(loud.map(|outcome| 1.0 / outcome.ratio()));
        let costs: Vec<Cost> = outcomes.iter().filter_map(|outcome| outcome.cost).collect();
        let excess = sorted(costs.iter().flat_map(Cost::excess));
        let clock = sorted(costs.iter().map(Cost::excess_ms));
        let codes = closed.iter().filter_map(|outcome| outcome.measured.picture_codes);
        Self {
            frames: closed.len(),
            open: open.len(),
            open_above: quantile(&sorted(open.iter().map(|outcome| outcome.measured.above)), 0.95),
            broken: closed.iter().filter(|outcome| outcome.is_broken()).count(),
            silent: closed.iter().filter(|outcome| outcome.is_silent()).count(),
            worst: closed.iter().map(|outcome| outcome.ratio()).fold(0.0, f64::max),
            median: quantile(&ratios, 0.5),
            exceeding: closed
                .iter()
                .filter(|outcome| outcome.measured.promise.exceeds)
                .count(),
            picture_codes: codes.max().unwrap_or(0),
            excess_median: quantile(&excess, 0.5),
            excess_95: quantile(&excess, 0.95),
            excess_max: quantile(&excess, 1.0),
            clock_median: quantile(&clock, 0.5),
            clock_95: quantile(&clock, 0.95),
        }
    }
}

pub(super) fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

/// A quantile of sorted values; NaN without values.
pub(super) fn quantile(sorted: &[f64], share: f64) -> f64 {
    let last = sorted.len().saturating_sub(1);
    let place = (share * last as f64).round() as usize;
    sorted.get(place).copied().unwrap_or(f64::NAN)
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

/// The figures as Markdown.
#[must_use]
pub fn markdown(outcomes: &[Outcome]) -> String {
    let mut text = "| frames | number | error / bound, largest | bound / error, median | above the bound | \
         above the tolerance with a reason | without a reason | without a bound | samples above in 95 % of these | codes off with `picture`, most |\n\
         |---|---|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    for kind in kinds(outcomes) {
        let own: Vec<&Outcome> = outcomes
            .iter()
            .filter(|outcome| outcome.origin.kind() == kind)
            .collect();
        text.push_str(&row(kind, &Summary::from_part(&own)));
    }
    let summary = Summary::new(outcomes);
    text.push_str(&row("all", &summary));
    text.push_str(&cost_table(&summary));
    for broken in worst(outcomes, Outcome::is_broken) {
        let [x, y, channel] = broken.measured.place;
        let _ = write!(
            text,
            "\n- {} ({}): error {:.2e} above {:.2e} in channel {channel} at ({x}, {y})",
            broken.origin.describe(),
            broken.about,
            broken.measured.error,
            broken.measured.promise.bound
        );
    }
    for silent in worst(outcomes, Outcome::is_silent) {
        let _ = write!(
            text,
            "\n- {} ({}): bound {:.2e} above the tolerance {:.2e}",
            silent.origin.describe(),
            silent.about,
            silent.measured.promise.bound,
            silent.tolerance
        );
    }
    text
}

fn row(kind: &str, summary: &Summary) -> String {
    let Summary {
        frames,
        worst,
        median,
        broken,
        exceeding,
        silent,
        open,
        open_above,
        picture_codes,
        ..
    } = summary;
    format!(
        "| {kind} | {frames} | {worst:.3} | {median:.1} | {broken} | {exceeding} | {silent} | {open} | {:.1} % | {picture_codes} |\n",
        100.0 * open_above
    )
}

fn cost_table(summary: &Summary) -> String {
    if summary.excess_median.is_nan() {
        return String::new();
    }
    format!(
        "\n| cost of water over the cheapest sufficient form | median | 95 % | largest |\n|---|---|---|---|\n\
         | kernels | {:.2} | {:.2} | {:.2} |\n| clock | {:.2} | {:.2} | |\n",
        summary.excess_median, summary.excess_95, summary.excess_max, summary.clock_median, summary.clock_95
    )
}

/// The failures that a report lists, the worst first.
#[must_use]
pub fn worst(outcomes: &[Outcome], fails: impl Fn(&Outcome) -> bool) -> Vec<&Outcome> {
    let mut failed: Vec<&Outcome> = outcomes.iter().filter(|outcome| fails(outcome)).collect();
    failed.sort_by(|a, b| b.ratio().total_cmp(&a.ratio()));
    failed.truncate(NAMED);
    failed
}
