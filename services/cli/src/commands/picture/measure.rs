//! `fathom measure`: quality metrics of the user's pictures.

use std::path::PathBuf;

use cli::exit::Failure;
use cli::files;
use cli::table::{decimal, table};
use quality::{MetricId, Needs, Profile};
use serde_json::{Map, Value, json};

/// Options of `fathom measure`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Pictures to measure
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Measure every metric of one profile instead of the usual six
    #[arg(long, value_parser = Profile::ALL.map(Profile::name))]
    profile: Option<String>,
    /// Metrics by name, such as uiqm or uiqm@table1, comma-separated
    #[arg(long, value_delimiter = ',', value_parser = metric, conflicts_with = "profile")]
    metrics: Vec<MetricId>,
    /// The clean picture, for psnr and ssim
    #[arg(long, value_name = "FILE")]
    clean: Option<PathBuf>,
    /// Print one JSON object per picture
    #[arg(long)]
    json: bool,
}

const USUAL: [&str; 6] = ["entropy", "uicm", "uism", "uiconm", "uiqm", "uciqe"];
/// Those that need the clean picture.
const COMPARING: [&str; 2] = ["psnr", "ssim"];

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let metrics = metrics(arguments);
    let clean = arguments
        .clean
        .as_deref()
        .map(files::read_picture)
        .transpose()?
        .map(|raster| raster.to_rgb8());
    let mut rows = Vec::new();
    for path in &arguments.files {
        let picture = files::read_picture(path)?.to_rgb8();
        let values = quality::measure(&picture, clean.as_ref(), &metrics)
            .map_err(|error| Failure::BadInput(format!("{}: {error}", path.display())))?;
        if arguments.json {
            let metrics: Map<String, Value> =
                values.iter().map(|(id, v)| (id.to_string(), json!(v))).collect();
            println!(
                "{}",
                json!({"file": path.display().to_string(), "width": picture.width(), "height": picture.height(), "metrics": metrics})
            );
        } else {
            let mut row = vec![path.display().to_string()];
            row.extend(values.iter().map(|(_, value)| decimal(*value)));
            rows.push(row);
        }
    }
    if !arguments.json {
        let names: Vec<String> = metrics.iter().map(MetricId::to_string).collect();
        let header: Vec<&str> = std::iter::once("file")
            .chain(names.iter().map(String::as_str))
            .collect();
        println!("{}", table(&header, &rows));
    }
    Ok(())
}

fn metrics(arguments: &Arguments) -> Vec<MetricId> {
    if !arguments.metrics.is_empty() {
        return arguments.metrics.clone();
    }
    let known = |name: &&str| MetricId::parse(name);
    let of_profile = |profile: &String| {
        MetricId::all()
            .filter(|id: &MetricId| {
                let info = id.info();
                info.needs == Needs::Nothing && info.profile.is_none_or(|its| its.name() == profile)
            })
            .collect()
    };
    let usual = || USUAL.iter().filter_map(known).collect();
    let mut metrics: Vec<MetricId> = arguments.profile.as_ref().map_or_else(usual, of_profile);
    if arguments.clean.is_some() {
        metrics.extend(COMPARING.iter().filter_map(known));
    }
    metrics
}

fn metric(name: &str) -> Result<MetricId, String> {
    MetricId::parse(name).ok_or_else(|| {
        let known: Vec<String> = MetricId::all().map(|id| id.to_string()).collect();
        format!("metric `{name}` does not exist; there is {}", known.join(", "))
    })
}
