//! The campaign as an experiment.

use cli::exit::Failure;

use super::climb::{Climb, list_climbs};
use super::family::Family;
use super::measured::bounded_studio;
use super::outcome::{Origin, Outcome};
use super::summary::{kinds, tables};
use crate::parallel::run_all;
use crate::plot::{Axis, Chart, Form, Lines, Series};
use crate::report::Report;
use crate::setup::{Parameter, Setup};

/// The parameters of a campaign.
pub const PARAMETERS: &[Parameter] = &[
    Parameter::number("frames", "2000", [0.0, 1e7], "random frames"),
    Parameter::number(
        "directed",
        "300",
        [0.0, 1e7],
        "directed frames, each against one bound",
    ),
    Parameter::number(
        "climbs",
        "20",
        [0.0, 1e4],
        "searches from the frames closest to their bounds",
    ),
    Parameter::number("steps", "10", [0.0, 1e4], "frames of each search"),
    Parameter::number("seed", "0", [0.0, 1e15], "the first seed"),
    Parameter::text("family", "only this family of frames"),
];
/// Maximum failures listed in a report, the worst of each kind.
const NAMED: usize = 20;
/// Smaller errors and bounds are drawn at this value.
const FLOOR: f64 = 1e-8;

/// Compares frames with their bounds. Each error above its bound and each bound above its tolerance without a reason is a failure.
///
/// # Errors
/// An unknown family.
pub fn run(setup: &Setup) -> Result<Report, Failure> {
    let family = setup.text("family").map(|name| {
        Family::parse(name)
            .ok_or_else(|| Failure::BadInput(format!("`family` is `{name}`; see docs/science/accuracy.md")))
    });
    let (frames, directed) = (setup.count("frames"), setup.count("directed"));
    let seed = setup.number("seed") as u64;
    let origins = Origin::list(seed, frames, directed, family.transpose()?);
    let outcomes = run_all("frames", None, &origins, bounded_studio, Outcome::measure);
    let mut outcomes: Vec<Outcome> = outcomes.into_iter().flatten().collect();
    let unrendered = origins.len() - outcomes.len();
    let climbs = list_climbs(&outcomes, setup.count("climbs"));
    let steps = setup.count("steps");
    let climbed = run_all(
        "searches",
        None,
        &climbs,
        bounded_studio,
        |climb: &Climb, studio| climb.run(studio, steps),
    );
    outcomes.extend(climbed.into_iter().flatten());
    let about = format!(
        "{} frames from seed {seed}, {unrendered} more that cannot be rendered.",
        outcomes.len()
    );
    let mut report = Report::new(about, tables(&outcomes));
    report.add_chart("campaign-bound", draw_bounds(&outcomes));
    for (place, broken) in find_worst(&outcomes, Outcome::is_broken).into_iter().enumerate() {
        report.failures.push(broken.describe());
        report
            .files
            .extend(broken.origin.case().files(&format!("above-{place}")));
    }
    let silent = find_worst(&outcomes, Outcome::is_silent).into_iter();
    report.failures.extend(silent.map(Outcome::describe));
    Ok(report)
}

/// The failures that a report lists, the worst first.
fn find_worst(outcomes: &[Outcome], fails: fn(&Outcome) -> bool) -> Vec<&Outcome> {
    let mut failed: Vec<&Outcome> = outcomes.iter().filter(|outcome| fails(outcome)).collect();
    failed.sort_by(|a, b| b.ratio().total_cmp(&a.ratio()));
    failed.truncate(NAMED);
    failed
}

/// Bound against error, with the line of equality.
fn draw_bounds(outcomes: &[Outcome]) -> Chart {
    let mut series: Vec<Series> = Vec::new();
    for kind in kinds(outcomes) {
        let closed = outcomes
            .iter()
            .filter(|outcome| outcome.origin.kind() == kind && !outcome.measured.promise.is_open);
        let points = closed.map(|outcome| {
            let measured = &outcome.measured;
            (measured.promise.bound.max(FLOOR), measured.error.max(FLOOR))
        });
        series.push(Series::new(kind, points, Form::Dots));
    }
    series.push(Series::new(
        "error = bound",
        [1e-6, 1.0].map(|v| (v, v)),
        Form::Line,
    ));
    Chart::Lines(Lines {
        title: "Every frame of the campaign".to_owned(),
        x: Axis::logarithmic("bound of the plan, linear light after exposure"),
        y: Axis::logarithmic("measured error"),
        series,
    })
}
