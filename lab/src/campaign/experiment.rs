//! The campaign as an experiment.

use std::panic::{AssertUnwindSafe, catch_unwind};

use cli::exit::Failure;

use super::climb::{climb, list_starts};
use super::family::list_families;
use super::measured::bounded_studio;
use super::outcome::{Origin, Outcome};
use super::summary::{kinds, summarize};
use crate::parallel::run_all;
use crate::report::Report;
use crate::setup::{Parameter, Setup};
use cli::plot::{Axis, Form, Lines, Series};

/// The parameters of a campaign.
pub const PARAMETERS: &[Parameter] = &[
    Parameter::number("frames", "2000", [0.0, 1e7], "random frames"),
    Parameter::number("directed", "300", [0.0, 1e7], "directed frames"),
    Parameter::number("climbs", "20", [0.0, 1e4], "searches"),
    Parameter::number("steps", "10", [0.0, 1e4], "frames of a search"),
    Parameter::number("seed", "0", [0.0, 1e15], "the first seed"),
    Parameter::text("family", "only this family of frames"),
];
/// Maximum failures listed in a report, the worst of each kind.
const NAMED: usize = 20;
/// Smaller errors and bounds are drawn at this value.
const FLOOR: f64 = 1e-8;

/// Compares frames with their bounds. Each panic, each error above its bound and each bound above its tolerance without a reason is a
/// failure.
///
/// # Errors
/// An unknown family.
pub fn run(setup: &Setup) -> Result<Report, Failure> {
    let (seed, family) = (setup.number("seed") as u64, setup.text("family"));
    let mut origins = Origin::list(seed, setup.count("frames"), &list_families(false, family)?);
    origins.extend(Origin::list(
        seed,
        setup.count("directed"),
        &list_families(true, family)?,
    ));
    let measured = run_all("frames", None, &origins, bounded_studio, |origin, studio| {
        let measured = catch_unwind(AssertUnwindSafe(|| Outcome::measure(origin, studio)));
        measured.map_err(|_| *studio = bounded_studio())
    });
    let panicked = origins
        .iter()
        .zip(&measured)
        .filter(|(_, measured)| measured.is_err());
    let panicked: Vec<String> = panicked
        .map(|(origin, _)| format!("a panic: {:?}", origin.source))
        .collect();
    let mut outcomes: Vec<Outcome> = measured.into_iter().flatten().flatten().collect();
    let unrendered = origins.len() - outcomes.len();
    let starts = list_starts(&outcomes, setup.count("climbs"));
    let steps = setup.count("steps");
    let climbed = run_all("searches", None, &starts, bounded_studio, |start, studio| {
        climb(start, studio, steps)
    });
    outcomes.extend(climbed.into_iter().flatten());
    let frames = outcomes.len();
    let about = format!("{frames} frames from seed {seed}, {unrendered} more that cannot be rendered.");
    let mut report = Report::new(about, vec![summarize(&outcomes)]);
    report.failures.extend(panicked);
    report.add_chart("campaign-bound", draw_bounds(&outcomes).svg());
    for (place, broken) in find_worst(&outcomes, Outcome::is_broken).into_iter().enumerate() {
        report.failures.push(broken.describe());
        let files = broken.origin.case().files(&format!("above-{place}"));
        report.files.extend(files);
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
fn draw_bounds(outcomes: &[Outcome]) -> Lines {
    let closed = outcomes.iter();
    let closed = closed.filter(|outcome| !outcome.measured.promise.is_open);
    let series = kinds(outcomes).into_iter().map(|kind| {
        let same = closed.clone().filter(|outcome| outcome.origin.kind() == kind);
        let points = same.map(|outcome| (outcome.measured.promise.bound, outcome.measured.error));
        let points = points.map(|(bound, error)| (bound.max(FLOOR), error.max(FLOOR)));
        Series::new(kind, points, Form::Dots)
    });
    let equal = Series::new("error = bound", [(1e-6, 1e-6), (1.0, 1.0)], Form::Line);
    Lines {
        title: "Every frame of the campaign".to_owned(),
        x: Axis::logarithmic("bound of the plan, linear light after exposure"),
        y: Axis::logarithmic("measured error"),
        series: series.chain([equal]).collect(),
    }
}
