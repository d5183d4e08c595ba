//! The chart of speed and accuracy as an experiment.

use anyhow::Context;
use cli::exit::Failure;
use cli::progress::Progress;
use style::Library;

use super::scenes::{ChartScene, standard_scenes};
use super::{forward_scatter, frame, ibla, lamps, style as tiers};
use crate::measurement::{Measurement, error_chart, mark_pareto, table};
use crate::report::Report;
use crate::setup::{Parameter, Setup};

/// The parameters of the chart.
pub const PARAMETERS: &[Parameter] = &[
    Parameter::text("stage", "only this stage"),
    Parameter::number("width", "768", [16.0, 8192.0], "columns of the scenes"),
    Parameter::number("runs", "9", [1.0, 1000.0], "runs of each variant"),
];
const STAGES: [&str; 5] = ["forward_scatter", "ibla", "lamps", "frame", "style"];

/// Measures every variant of every stage on the standard scenes.
///
/// # Errors
/// An unknown stage.
pub fn run(setup: &Setup) -> Result<Report, Failure> {
    let stages: Vec<&str> = match setup.text("stage") {
        None => STAGES.to_vec(),
        Some(only) if STAGES.contains(&only) => vec![only],
        Some(other) => {
            let known = STAGES.join(", ");
            return Err(Failure::BadInput(format!(
                "`stage` is {other}; must be one of {known}"
            )));
        }
    };
    let scenes = standard_scenes(setup.count("width"));
    let library = Library::embedded().context("the embedded style models")?;
    let runs = setup.count("runs");
    let mut progress = Progress::new("chart", "stages", (scenes.len() * stages.len()) as u64);
    let mut measured = Vec::new();
    let pairs = scenes
        .iter()
        .flat_map(|scene| stages.iter().map(move |stage| (scene, stage)));
    for (done, (scene, stage)) in pairs.enumerate() {
        measured.extend(measure(stage, scene, &library, runs));
        progress.set(done as u64 + 1);
    }
    progress.finish();
    mark_pareto(&mut measured);
    let about = format!("Error against time of each variant; {runs} runs of each, after one to warm up.");
    let mut report = Report::new(about, vec![table("chart", &measured)]);
    for scene in &scenes {
        for stage in &stages {
            let points = measured
                .iter()
                .filter(|m| m.stage == *stage && m.case == scene.name);
            let points: Vec<Measurement> = points.cloned().collect();
            let (width, height) = scene.range.size();
            let title = format!("{stage}, {}, {width}x{height}", scene.name);
            report.add_chart(
                format!("{stage}-{}", scene.name),
                error_chart(&title, &points).svg(),
            );
        }
    }
    Ok(report)
}

fn measure(stage: &str, scene: &ChartScene, library: &Library, runs: usize) -> Vec<Measurement> {
    match stage {
        "forward_scatter" => forward_scatter::measure(scene, runs),
        "ibla" => ibla::measure(scene, runs),
        "lamps" => lamps::measure(scene, runs),
        "style" => tiers::measure(scene, library, runs),
        _ => frame::measure(scene, runs),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stage_measures_its_exact_variant_as_exact() {
        let scene = &standard_scenes(48)[1];
        let library = Library::embedded().unwrap();
        let mut all: Vec<Measurement> = Vec::new();
        for stage in STAGES {
            let mut measured = measure(stage, scene, &library, 1);
            mark_pareto(&mut measured);
            let defaults = measured.iter().filter(|m| m.is_default).count();
            assert_eq!(defaults, 1, "{stage}");
            assert!(measured.iter().any(|m| m.is_pareto), "{stage}");
            let errors = measured.iter().filter_map(|m| Some(m.difference?.max));
            let least = errors.fold(f64::INFINITY, f64::min);
            // The airlight of a lamp in view reaches 100, which f32 represents to 8e-6.
            let limit = if stage == "lamps" { 2e-5 } else { 3e-6 };
            assert!(least < limit, "{stage}: {least:e}");
            assert!(error_chart(stage, &measured).svg().contains("</svg>"));
            all.extend(measured);
        }
        let error = |variant: &str, terms| {
            let found = all.iter().find(|m| m.variant == variant && m.terms == terms);
            found.unwrap().difference.unwrap().max
        };
        assert!(error("chebyshev", Some(12)) < error("chebyshev", Some(4)));
        assert_eq!(table("chart", &all).rows().len(), all.len());
    }
}
