//! The table of experiments.

use std::path::{Path, PathBuf};

use cli::exit::Failure;
use cli::files;
use cli::styles::StyleArguments;

use crate::report::Report;
use crate::setup::{Parameter, Setup};
use crate::{campaign, chain, chart, jobs, stability};

/// The code or file of an experiment.
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

macro_rules! experiments {
    (code { $($name:literal, $about:literal, $parameters:expr, $run:expr;)* } jobs { $($job:literal, $job_about:literal;)* }) => {
        const EXPERIMENTS: &[Experiment] = &[
            $(Experiment { name: $name, about: $about, parameters: $parameters, work: Work::Code($run) },)*
            $(Experiment {
                name: $job,
                about: $job_about,
                parameters: jobs::PARAMETERS,
                work: Work::Jobs(include_str!(concat!("../experiments/", $job, ".json"))),
            },)*
        ];
    };
}

experiments! {
    code {
        "chart", "error against time of every variant of a stage", chart::PARAMETERS, chart::run;
        "campaign", "random, directed and climbing frames against the bounds of their plans", campaign::PARAMETERS, campaign::run;
        "chain", "hostile frames through the chain of the water, each against its limit", &[], chain::run;
        "stability", "failure regions of enhancements and metrics", stability::PARAMETERS, stability::run;
    }
    jobs {
        "ibla", "the faster variant of IBLA against the exact one";
        "truth", "plain jobs by day and by night against Monte Carlo";
        "sites", "lightness, contrast, water and effects of the frames of every site";
        "photographs", "features of the frames of every site next to those of photographs";
        "ladder", "the effects of the published chain, one by one";
        "families", "every family in five waters, with the time of the stages";
        "wall", "one wall in Jerlov's waters";
        "camera", "one frame with several cameras";
        "suspended", "one frame with snow and turbidity";
        "sequence", "four frames of a sequence with snow and turbidity";
    }
}

/// The experiments with their parameters.
fn describe_all() -> String {
    let mut text = String::from("Experiments, and their parameters for --set:\n");
    for Experiment {
        name,
        about,
        parameters,
        ..
    } in EXPERIMENTS
    {
        text += &format!("\n  {name:<12} {about}\n");
        for Parameter {
            name, default, about, ..
        } in *parameters
        {
            text += &format!("    {name}={default}  {about}\n");
        }
    }
    text
}

/// What to run.
#[derive(clap::Args)]
pub struct Request {
    /// A name from the list, or a JSON file: a job, or cases, variants and measurements like those in lab/experiments
    name: Option<String>,
    /// Files that the experiment measures; jobs replace the cases of an experiment on jobs
    inputs: Vec<PathBuf>,
    /// A parameter of the experiment; may be repeated
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<String>,
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "target/experiments")]
    out: PathBuf,
    #[command(flatten)]
    styles: StyleArguments,
}

/// Runs a named experiment, or that of a JSON file, and writes its report into a folder; without a name, lists all experiments.
///
/// # Errors
/// An unknown name, wrong parameters, or a failure of the experiment.
pub fn run(request: Request) -> Result<(), Failure> {
    let Some(name) = &request.name else {
        println!("{}", describe_all());
        return Ok(());
    };
    let known = EXPERIMENTS.iter().find(|experiment| experiment.name == name);
    if known.is_none() && !name.ends_with(".json") {
        let names: Vec<&str> = EXPERIMENTS.iter().map(|experiment| experiment.name).collect();
        let names = names.join(", ");
        return Err(Failure::BadInput(format!(
            "there is no experiment `{name}`; name a JSON file or one of {names}"
        )));
    }
    let parameters = known.map_or(jobs::PARAMETERS, |experiment| experiment.parameters);
    let mut setup = Setup::new(parameters, request.styles);
    setup.set(parameters, &request.set)?;
    setup.inputs = request.inputs;
    let path = Path::new(name);
    let stem = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or(name);
    let report = match known.map(|experiment| &experiment.work) {
        Some(Work::Code(run)) => run(&setup),
        Some(Work::Jobs(text)) => jobs::run(text, Path::new(""), name, &setup),
        None => {
            let text = String::from_utf8_lossy(&files::read(path)?).into_owned();
            jobs::run(&text, path.parent().unwrap_or(path), stem, &setup)
        }
    };
    report?.write(stem, &request.out)
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
