//! Charts of a campaign.

use super::report::{kinds, quantile, sorted};
use super::{Measured, Outcome};
use crate::plot::{Axis, Form, Lines, Mark, Series};

/// Smaller errors and bounds are drawn at this value.
const FLOOR: f64 = 1e-8;

/// Bound against error, with the line of equality.
#[must_use]
pub fn bound_chart(outcomes: &[Outcome]) -> Lines {
    let mut series: Vec<Series> = Vec::new();
    for kind in kinds(outcomes) {
        let own = outcomes.iter().filter(|outcome| outcome.origin.kind() == kind);
        let closed = own.filter(|outcome| !outcome.measured.promise.is_open);
        series.push(Series {
            name: kind.to_owned(),
            marks: closed.map(bound_mark).collect(),
            form: Form::Dots,
        });
    }
    series.push(Series {
        name: "error = bound".to_owned(),
        marks: [1e-6, 1.0].map(|v| mark(v, v)).into(),
        form: Form::Line,
    });
    Lines {
        title: "Every frame of the campaign".to_owned(),
        x: axis("bound of the plan, linear light after exposure", true),
        y: axis("measured error", true),
        series,
    }
}

/// Cost of the channels in water alone over the cheapest sufficient plan, in ascending order; `None` without such frames.
#[must_use]
pub fn cost_chart(outcomes: &[Outcome]) -> Option<Lines> {
    let costs = outcomes.iter().filter_map(|outcome| outcome.cost);
    let excess = sorted(costs.flat_map(|cost| cost.excess()));
    if excess.is_empty() {
        return None;
    }
    let shares = (0..=200).map(|share| f64::from(share) / 200.0);
    let marks = shares.map(|share| mark(100.0 * share, quantile(&excess, share)));
    Some(Lines {
        title: "Cost of the plan over the cheapest sufficient form".to_owned(),
        x: axis("percent of channels", false),
        y: axis("cost / cheapest", false),
        series: vec![Series {
            name: "campaign".to_owned(),
            marks: marks.collect(),
            form: Form::Line,
        }],
    })
}

fn axis(title: &str, logarithmic: bool) -> Axis {
    Axis {
        title: title.to_owned(),
        logarithmic,
    }
}

fn bound_mark(outcome: &Outcome) -> Mark {
    let Measured { promise, error, .. } = outcome.measured;
    mark(promise.bound.max(FLOOR), error.max(FLOOR))
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
