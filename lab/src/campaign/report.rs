//! The campaign in figures, words and drawings.

use super::Outcome;
use crate::plot::{Axis, Form, Lines, Mark, Series};

/// Figures of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Channels of frames.
    pub channels: usize,
    /// Those of frames with lamps, patches or snow.
    pub mixtures: usize,
    /// Errors above their bound.
    pub broken: usize,
    /// Bounds above their tolerance of which the plan does not say why.
    pub silent: usize,
    /// Channels of water alone that are transformed.
    pub transformed: usize,
    /// The smallest ratio of bound to error where something is transformed and f32 does not hide the error.
    pub closest: f64,
    /// Half of these ratios are no larger.
    pub ratio_median: f64,
    /// The smallest ratio of bound to error in a mixture.
    pub mixture_closest: f64,
    /// Half of these ratios are no larger.
    pub mixture_median: f64,
    /// Cost in units of the cheapest sufficient form: half cost no more.
    pub excess_median: f64,
    /// 95 % cost no more.
    pub excess_95: f64,
    /// The largest.
    pub excess_max: f64,
    /// The same by the clock, frame by frame.
    pub clock_median: f64,
    /// 95 % took no longer.
    pub clock_95: f64,
    /// Largest difference of 8-bit codes where `display` was asked for.
    pub display_codes: u8,
}

/// Errors below this are mostly rounding.
const ROUNDING: f64 = 3e-6;

impl Summary {
    /// Sums up.
    #[must_use]
    pub fn new(outcomes: &[Outcome]) -> Self {
        let sorted = |values: Vec<f64>| {
            let mut values = values;
            values.sort_by(f64::total_cmp);
            values
        };
        let at = |values: &[f64], share: f64| {
            let last = values.len().saturating_sub(1);
            values
                .get((share * last as f64).round() as usize)
                .copied()
                .unwrap_or(f64::NAN)
        };
        let ratios = |counts: &dyn Fn(&Outcome) -> bool| {
            let loud = outcomes.iter().filter(|o| o.error > ROUNDING && counts(o));
            sorted(loud.map(|o| o.bound / o.error).collect())
        };
        let (mixtures, ratios) = (ratios(&Outcome::is_mixture), ratios(&is_transformed));
        let costs = outcomes.iter().filter_map(|o| o.cost);
        let excess = sorted(costs.map(|cost| cost.excess()).collect());
        let first = outcomes.iter().filter(|o| o.channel == 0);
        let clock = sorted(first.filter_map(|o| Some(o.cost?.excess_ms())).collect());
        Self {
            channels: outcomes.len(),
            mixtures: outcomes.iter().filter(|o| o.is_mixture()).count(),
            broken: outcomes.iter().filter(|o| o.is_broken()).count(),
            silent: outcomes.iter().filter(|o| o.is_silent()).count(),
            transformed: outcomes.iter().filter(|o| is_transformed(o)).count(),
            closest: at(&ratios, 0.0),
            ratio_median: at(&ratios, 0.5),
            mixture_closest: at(&mixtures, 0.0),
            mixture_median: at(&mixtures, 0.5),
            excess_median: at(&excess, 0.5),
            excess_95: at(&excess, 0.95),
            excess_max: at(&excess, 1.0),
            clock_median: at(&clock, 0.5),
            clock_95: at(&clock, 0.95),
            display_codes: outcomes.iter().filter_map(|o| o.display_codes).max().unwrap_or(0),
        }
    }
}

fn is_transformed(outcome: &Outcome) -> bool {
    outcome.cost.is_some_and(|cost| cost.terms > 0)
}

/// The figures as text.
#[must_use]
pub fn markdown(outcomes: &[Outcome]) -> String {
    let summary = Summary::new(outcomes);
    let mut text = "| figure | value | promised |\n|---|---|---|\n".to_owned();
    let mut row = |what: &str, value: String, promised: &str| {
        text.push_str(&format!("| {what} | {value} | {promised} |\n"));
    };
    row("channels of frames", summary.channels.to_string(), "");
    row(
        "of them with lamps, patches or snow",
        summary.mixtures.to_string(),
        "",
    );
    row("of water alone, transformed", summary.transformed.to_string(), "");
    row("errors above their bound", summary.broken.to_string(), "0");
    row(
        "bounds above the tolerance without a reason in the plan",
        summary.silent.to_string(),
        "0",
    );
    let closest = |ratio: f64| format!("{ratio:.2}");
    row("water: bound / error, smallest", closest(summary.closest), "≥ 1");
    row(
        "water: bound / error, median",
        format!("{:.1}", summary.ratio_median),
        "",
    );
    row(
        "with lamps, patches or snow: bound / error, smallest",
        closest(summary.mixture_closest),
        "≥ 1",
    );
    row(
        "with lamps, patches or snow: bound / error, median",
        format!("{:.1}", summary.mixture_median),
        "",
    );
    let codes = summary.display_codes.to_string();
    row("8-bit codes off where `display` is asked for, most", codes, "≤ 1");
    let excess = |value: f64| format!("{value:.2}");
    row(
        "kernels: cost / cheapest, median",
        excess(summary.excess_median),
        "≤ 1.5",
    );
    row("kernels: cost / cheapest, 95 %", excess(summary.excess_95), "≤ 2");
    row(
        "kernels: cost / cheapest, largest",
        excess(summary.excess_max),
        "",
    );
    row(
        "clock: cost / cheapest, median",
        excess(summary.clock_median),
        "≤ 1.5",
    );
    row("clock: cost / cheapest, 95 %", excess(summary.clock_95), "≤ 2");
    for broken in outcomes.iter().filter(|o| o.is_broken()) {
        text.push_str(&format!(
            "\n- frame {} channel {} ({}): error {:.2e} above {:.2e}",
            broken.seed, broken.channel, broken.about, broken.error, broken.bound
        ));
    }
    for silent in outcomes.iter().filter(|o| o.is_silent()) {
        text.push_str(&format!(
            "\n- frame {} channel {} ({}): bound {:.2e} above the tolerance {:.2e}",
            silent.seed, silent.channel, silent.about, silent.bound, silent.tolerance
        ));
    }
    text
}

/// Points that a chart can hold.
const DRAWN: usize = 4000;

/// Bound against error, with the line that no point may be above.
#[must_use]
pub fn bound_chart(outcomes: &[Outcome]) -> Lines {
    let floor = |error: f64| error.max(1e-8);
    let step = outcomes.len().div_ceil(DRAWN).max(1);
    let dots = |name: &str| Series {
        name: name.to_owned(),
        marks: outcomes
            .iter()
            .step_by(step)
            .filter(|o| o.about.starts_with(name) && (o.is_mixture() || is_transformed(o)))
            .map(|o| mark(o.bound, floor(o.error)))
            .collect(),
        form: Form::Dots,
    };
    let limit = [1e-6, 1.0].map(|v| mark(v, v)).into();
    let axis = |title: &str| Axis {
        title: title.to_owned(),
        logarithmic: true,
    };
    Lines {
        title: "Every transformed channel and every mixture of the campaign".to_owned(),
        x: axis("bound of the plan, linear light"),
        y: axis("measured error"),
        series: vec![
            dots("jaffe"),
            dots("simplified"),
            dots("mixture"),
            Series {
                name: "error = bound".to_owned(),
                marks: limit,
                form: Form::Line,
            },
        ],
    }
}

/// How many channels cost how much more than the cheapest sufficient form.
#[must_use]
pub fn cost_chart(outcomes: &[Outcome]) -> Lines {
    let costs = outcomes.iter().filter_map(|outcome| outcome.cost);
    let mut excess: Vec<f64> = costs.map(|cost| cost.excess()).collect();
    excess.sort_by(f64::total_cmp);
    let last = excess.len().saturating_sub(1).max(1);
    let marks = (0..=200).filter_map(|share| {
        let place = share * last / 200;
        Some(mark(100.0 * place as f64 / last as f64, *excess.get(place)?))
    });
    let axis = |title: &str| Axis {
        title: title.to_owned(),
        logarithmic: false,
    };
    Lines {
        title: "Cost of the plan over the cheapest sufficient form".to_owned(),
        x: axis("percent of channels"),
        y: axis("cost / cheapest"),
        series: vec![Series {
            name: "campaign".to_owned(),
            marks: marks.collect(),
            form: Form::Line,
        }],
    }
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
