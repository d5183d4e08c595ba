//! The table of experiments.

use std::path::{Path, PathBuf};

use cli::exit::Failure;
use cli::files;
use cli::styles::StyleArguments;

use crate::report::Report;
use crate::setup::{Parameter, Setup};
use crate::{
    campaign, chain, chart, ibla, jobs, lamps, service, speed, stability, styles, table1, truth, waters,
};

/// What an experiment runs.
enum Work {
    /// Cases and variants as JSON, from lab/experiments.
    Jobs(&'static str),
    /// A measurement in code.
    Code(fn(&Setup) -> Result<Report, Failure>),
}

/// A named experiment.
struct Experiment {
    name: &'static str,
    about: &'static str,
    parameters: &'static [Parameter],
    work: Work,
}

macro_rules! jobs {
    ($name:literal, $about:literal) => {
        Experiment {
            name: $name,
            about: $about,
            parameters: jobs::PARAMETERS,
            work: Work::Jobs(include_str!(concat!("../experiments/", $name, ".json"))),
        }
    };
}

const fn code(
    name: &'static str,
    about: &'static str,
    parameters: &'static [Parameter],
    run: fn(&Setup) -> Result<Report, Failure>,
) -> Experiment {
    Experiment {
        name,
        about,
        parameters,
        work: Work::Code(run),
    }
}

const EXPERIMENTS: &[Experiment] = &[
    code(
        "chart",
        "error against time of the variants of each stage; inputs: a picture and its range (.npy)",
        chart::PARAMETERS,
        chart::run,
    ),
    code(
        "campaign",
        "random, directed and climbing frames against the bounds of their plans",
        campaign::PARAMETERS,
        campaign::run,
    ),
    code(
        "chain",
        "hostile frames through the chain of the water, each against its limit",
        &[],
        chain::run,
    ),
    code(
        "stability",
        "failure regions of enhancements and metrics",
        stability::PARAMETERS,
        stability::run,
    ),
    code(
        "style-stability",
        "style networks under noise, moves, crops and extreme sizes",
        &[],
        styles::run_stability,
    ),
    code(
        "style-speed",
        "time of the tiers of a style network",
        styles::SPEED_PARAMETERS,
        styles::run_speed,
    ),
    code(
        "training-scores",
        "a trained style over several sets of scenes; inputs: the model and its photos",
        styles::SCORES_PARAMETERS,
        styles::run_scores,
    ),
    code(
        "table1",
        "the enhancement methods over the pictures of a folder",
        table1::PARAMETERS,
        table1::run,
    ),
    code(
        "ibla",
        "the faster variant of IBLA against the exact one; inputs: jobs",
        ibla::PARAMETERS,
        ibla::run,
    ),
    code(
        "truth",
        "one frame by Monte Carlo; input: a job",
        truth::PARAMETERS,
        truth::run,
    ),
    code(
        "lamps",
        "lamps in six waters against Monte Carlo",
        lamps::PARAMETERS,
        lamps::run,
    ),
    code(
        "waters",
        "curves of transmittance, daylight and visibility, and grey cards",
        &[],
        waters::run,
    ),
    code(
        "speed",
        "frames and stages on one slot and on all, memory, kernels",
        speed::PARAMETERS,
        speed::run,
    ),
    code(
        "service",
        "submissions, claims, pages and counts over a large catalogue; input: a folder",
        service::PARAMETERS,
        service::run,
    ),
    jobs!("plain", "plain jobs by day and by night against Monte Carlo"),
    jobs!(
        "sites",
        "lightness, contrast, water and effects of the frames of every site"
    ),
    jobs!(
        "photographs",
        "features of the frames of every site next to those of photographs"
    ),
    jobs!("ladder", "the effects of the published chain, one by one"),
    jobs!(
        "families",
        "every family in five waters, with the time of the stages"
    ),
    jobs!("wall", "one wall in Jerlov's waters"),
    jobs!("labels", "the labels of three families"),
    jobs!("camera", "one frame with several cameras"),
    jobs!("suspended", "one frame with snow and turbidity"),
    jobs!("sequence", "four frames of a sequence with snow and turbidity"),
    jobs!("figure5", "every step of the published chain"),
    jobs!("figure6", "every style water"),
];

/// The experiments with their parameters, one per line.
#[must_use]
pub fn describe_all() -> String {
    let mut text = String::from("Experiments, and their parameters for --set:\n");
    for experiment in EXPERIMENTS {
        text.push_str(&format!("\n  {:<16} {}\n", experiment.name, experiment.about));
        for parameter in experiment.parameters {
            let Parameter {
                name, default, about, ..
            } = parameter;
            let default = if default.is_empty() {
                String::new()
            } else {
                format!(" [{default}]")
            };
            text.push_str(&format!("    {name}: {about}{default}\n"));
        }
    }
    text
}

/// Runs a named experiment, or that of a JSON file, and writes its report into a folder.
///
/// # Errors
/// An unknown name, wrong parameters, or a failure of the experiment.
pub fn run(
    name: &str,
    settings: &[String],
    inputs: Vec<PathBuf>,
    styles: StyleArguments,
    out: &Path,
) -> Result<(), Failure> {
    if let Some(experiment) = EXPERIMENTS.iter().find(|experiment| experiment.name == name) {
        let setup = Setup::new(experiment.parameters, settings, inputs, styles)?;
        let report = match experiment.work {
            Work::Jobs(text) => jobs::run(text, Path::new("."), name, &setup)?,
            Work::Code(run) => run(&setup)?,
        };
        return report.write(name, out);
    }
    let path = Path::new(name);
    let Some(stem) = path
        .file_stem()
        .and_then(|stem| stem.to_str())
        .filter(|_| name.ends_with(".json"))
    else {
        let known: Vec<&str> = EXPERIMENTS.iter().map(|experiment| experiment.name).collect();
        return Err(Failure::BadInput(format!(
            "there is no experiment `{name}`; name a JSON file or one of {}",
            known.join(", ")
        )));
    };
    let setup = Setup::new(jobs::PARAMETERS, settings, inputs, styles)?;
    let text = String::from_utf8_lossy(&files::read(path)?).into_owned();
    let folder = path.parent().unwrap_or(Path::new("."));
    jobs::run(&text, folder, stem, &setup)?.write(stem, out)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn experiments_have_distinct_names_and_valid_descriptions() {
        let names: BTreeSet<&str> = EXPERIMENTS.iter().map(|experiment| experiment.name).collect();
        assert_eq!(names.len(), EXPERIMENTS.len());
        for experiment in EXPERIMENTS {
            if let Work::Jobs(text) = experiment.work {
                jobs::check(text, experiment.name).unwrap();
            }
        }
    }
}
