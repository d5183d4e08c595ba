//! The campaign in figures, words and drawings.

use std::fmt::Write as _;

use super::{Cost, Outcome};
use crate::plot::{Axis, Form, Lines, Mark, Series};

/// Errors below this are mostly rounding.
const ROUNDING: f64 = 3e-6;
/// Frames that are named in a report, the worst of each kind of failure.
const NAMED: usize = 20;

/// Figures of a campaign, or of a part of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Frames with a promise.
    pub frames: usize,
    /// Frames with a stage that runs without a bound; they are in no other figure.
    pub open: usize,
    /// Errors above their bound.
    pub broken: usize,
    /// Bounds above their tolerance of which the plan gives no reason.
    pub silent: usize,
    /// The largest share of a bound that an error reaches.
    pub worst: f64,
    /// Median of bound over error where f32 does not hide the error.
    pub median: f64,
    /// Frames whose plan gives a reason why it exceeds the tolerance.
    pub exceeding: usize,
    /// Largest difference of 8-bit codes where `display` was asked for.
    pub display_codes: u8,
    /// Cost of water in units of the cheapest sufficient form: half of the channels cost no more.
    pub excess_median: f64,
    /// 95 % cost no more.
    pub excess_95: f64,
    /// The largest.
    pub excess_max: f64,
    /// The same by the clock, frame by frame: half took no longer.
    pub clock_median: f64,
    /// 95 % took no longer.
    pub clock_95: f64,
}

impl Summary {
    /// Sums up.
    #[must_use]
    pub fn new(outcomes: &[Outcome]) -> Self {
        let all: Vec<&Outcome> = outcomes.iter().collect();
        Self::of(&all)
    }

    fn of(outcomes: &[&Outcome]) -> Self {
        let is_open = |outcome: &&&Outcome| outcome.measured.promise.is_open;
        let open = outcomes.iter().filter(is_open).count();
        let closed: Vec<&Outcome> = outcomes.iter().filter(|o| !is_open(o)).copied().collect();
        let loud = closed.iter().filter(|o| o.measured.error > ROUNDING);
        let ratios = sorted(loud.map(|o| 1.0 / o.ratio()));
        let costs = || outcomes.iter().filter_map(|o| o.cost);
        let excess = sorted(costs().flat_map(|cost| cost.excess()));
        let clock = sorted(costs().map(|cost| cost.excess_ms()));
        Self {
            frames: closed.len(),
            open,
            broken: closed.iter().filter(|o| o.is_broken()).count(),
            silent: closed.iter().filter(|o| o.is_silent()).count(),
            worst: closed.iter().map(|o| o.ratio()).fold(0.0, f64::max),
            median: quantile(&ratios, 0.5),
            exceeding: closed.iter().filter(|o| o.measured.promise.exceeds).count(),
            display_codes: closed
                .iter()
                .filter_map(|o| o.measured.display_codes)
                .max()
                .unwrap_or(0),
            excess_median: quantile(&excess, 0.5),
            excess_95: quantile(&excess, 0.95),
            excess_max: quantile(&excess, 1.0),
            clock_median: quantile(&clock, 0.5),
            clock_95: quantile(&clock, 0.95),
        }
    }
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The value at a share of the sorted ones; NaN without any.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let last = sorted.len().saturating_sub(1);
    let place = (share * last as f64).round() as usize;
    sorted.get(place).copied().unwrap_or(f64::NAN)
}

/// Kinds of frames in the order in which they are first met.
fn kinds(outcomes: &[Outcome]) -> Vec<&'static str> {
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
         above the tolerance with a reason | without a reason | without a bound | codes off with `display`, most |\n\
         |---|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    let mut add = |kind: &str, summary: &Summary| {
        let _ = writeln!(
            text,
            "| {kind} | {} | {:.3} | {:.1} | {} | {} | {} | {} | {} |",
            summary.frames,
            summary.worst,
            summary.median,
            summary.broken,
            summary.exceeding,
            summary.silent,
            summary.open,
            summary.display_codes
        );
    };
    for kind in kinds(outcomes) {
        let own: Vec<&Outcome> = outcomes.iter().filter(|o| o.origin.kind() == kind).collect();
        add(kind, &Summary::of(&own));
    }
    let summary = Summary::new(outcomes);
    add("all", &summary);
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

/// Frames of a kind of failure, the worst first.
#[must_use]
pub fn worst(outcomes: &[Outcome], fails: impl Fn(&Outcome) -> bool) -> Vec<&Outcome> {
    let mut failed: Vec<&Outcome> = outcomes.iter().filter(|outcome| fails(outcome)).collect();
    failed.sort_by(|a, b| b.ratio().total_cmp(&a.ratio()));
    failed.truncate(NAMED);
    failed
}

/// Bound against error, with the line that no point may be above.
#[must_use]
pub fn bound_chart(outcomes: &[Outcome]) -> Lines {
    /// Errors below are drawn here.
    const FLOOR: f64 = 1e-8;
    let dots = |kind: &&'static str| Series {
        name: (*kind).to_owned(),
        marks: outcomes
            .iter()
            .filter(|o| o.origin.kind() == *kind && !o.measured.promise.is_open)
            .map(|o| mark(o.measured.promise.bound.max(FLOOR), o.measured.error.max(FLOOR)))
            .collect(),
        form: Form::Dots,
    };
    let axis = |title: &str| Axis {
        title: title.to_owned(),
        logarithmic: true,
    };
    let limit = Series {
        name: "error = bound".to_owned(),
        marks: [1e-6, 1.0].map(|v| mark(v, v)).into(),
        form: Form::Line,
    };
    let kinds = kinds(outcomes);
    Lines {
        title: "Every frame of the campaign".to_owned(),
        x: axis("bound of the plan, linear light after exposure"),
        y: axis("measured error"),
        series: kinds.iter().map(dots).chain([limit]).collect(),
    }
}

/// How many channels of water alone cost how much more than the cheapest sufficient form; `None` without such frames.
#[must_use]
pub fn cost_chart(outcomes: &[Outcome]) -> Option<Lines> {
    let costs = outcomes.iter().filter_map(|outcome| outcome.cost);
    let excess = sorted(costs.flat_map(|cost: Cost| cost.excess()));
    if excess.is_empty() {
        return None;
    }
    let marks = (0..=200).map(|share| {
        let share = f64::from(share) / 200.0;
        mark(100.0 * share, quantile(&excess, share))
    });
    let axis = |title: &str| Axis {
        title: title.to_owned(),
        logarithmic: false,
    };
    Some(Lines {
        title: "Cost of the plan over the cheapest sufficient form".to_owned(),
        x: axis("percent of channels"),
        y: axis("cost / cheapest"),
        series: vec![Series {
            name: "campaign".to_owned(),
            marks: marks.collect(),
            form: Form::Line,
        }],
    })
}

fn mark(x: f64, y: f64) -> Mark {
    Mark {
        x,
        y,
        reach: None,
        label: String::new(),
        ringed: false,
    }
}
