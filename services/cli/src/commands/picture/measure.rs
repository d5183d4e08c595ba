//! `fathom measure`: quality metrics of the user's pictures.

use std::path::PathBuf;
use std::sync::Arc;

use cli::exit::Failure;
use cli::files;
use cli::styles::StyleArguments;
use cli::table::{decimal, table};
use imaging::Rgb8;
use quality::{MetricId, Needs, Profile};
use renderer::{Engine, PictureNetworks};
use serde_json::{Map, Value, json};
use spec::METRIC_NETWORK;
use style::ModelRole;

/// Options of `fathom measure`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Pictures to measure
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Measure every metric of one profile instead of the usual six
    #[arg(long, value_parser = Profile::ALL.map(Profile::name))]
    profile: Option<String>,
    /// Metrics by name, such as uiqm or uiqm@table1, comma-separated; net.NAME is a metric network of --styles
    #[arg(long, value_delimiter = ',', conflicts_with = "profile")]
    metrics: Vec<String>,
    /// The clean picture, for psnr and ssim
    #[arg(long, value_name = "FILE")]
    clean: Option<PathBuf>,
    /// Print one JSON object per picture
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    style: StyleArguments,
}

const USUAL: [&str; 6] = ["entropy", "uicm", "uism", "uiconm", "uiqm", "uciqe"];
/// Those that need the clean picture.
const COMPARING: [&str; 2] = ["psnr", "ssim"];

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut gauge = Gauge::new(arguments)?;
    let clean = arguments
        .clean
        .as_deref()
        .map(files::read_picture)
        .transpose()?
        .map(|raster| raster.to_rgb8());
    let mut rows = Vec::new();
    for path in &arguments.files {
        let picture = files::read_picture(path)?.to_rgb8();
        let values = gauge
            .measure(&picture, clean.as_ref())
            .map_err(|reason| Failure::BadInput(format!("{}: {reason}", path.display())))?;
        if arguments.json {
            let named = gauge.names.iter().cloned().zip(&values);
            let metrics: Map<String, Value> = named.map(|(name, value)| (name, json!(value))).collect();
            println!(
                "{}",
                json!({"file": path.display().to_string(), "width": picture.width(), "height": picture.height(), "metrics": metrics})
            );
        } else {
            let mut row = vec![path.display().to_string()];
            row.extend(values.into_iter().map(decimal));
            rows.push(row);
        }
    }
    if !arguments.json {
        let header: Vec<&str> = std::iter::once("file")
            .chain(gauge.names.iter().map(String::as_str))
            .collect();
        println!("{}", table(&header, &rows));
    }
    Ok(())
}

/// The metrics of a command, and the networks among them.
struct Gauge {
    /// Their names in the order of the request.
    names: Vec<String>,
    registered: Vec<MetricId>,
    networks: PictureNetworks,
}

impl Gauge {
    fn new(arguments: &Arguments) -> Result<Self, Failure> {
        let library = arguments.style.library()?;
        let names = list_names(arguments);
        let mut registered = Vec::new();
        let mut unknown = Vec::new();
        let mut has_network = false;
        for name in &names {
            let network = name.strip_prefix(METRIC_NETWORK);
            let network = network.and_then(|network| library.get(network));
            match (MetricId::parse(name), network) {
                (Some(id), _) => registered.push(id),
                (None, Some(model)) if model.card.role == ModelRole::Metric => has_network = true,
                (None, _) => unknown.push(format!("`{name}`")),
            }
        }
        if !unknown.is_empty() {
            let known = MetricId::all().map(|id| id.to_string());
            let networks = library.of_role(ModelRole::Metric);
            let networks = networks.map(|model| format!("{METRIC_NETWORK}{}", model.name));
            let known: Vec<String> = known.chain(networks).collect();
            let (unknown, known) = (unknown.join(", "), known.join(", "));
            let message = format!("metric {unknown} does not exist; there is {known}");
            return Err(Failure::BadInput(message));
        }
        let has_comparison = registered.iter().any(|id| id.info().needs == Needs::PictureInAir);
        if arguments.clean.is_some() && !has_comparison {
            let compared = COMPARING.join(", ");
            let message =
                format!("--clean has no effect: no metric compares with it; add {compared}, or leave it out");
            return Err(Failure::BadInput(message));
        }
        let engine = Arc::new(Engine::new(library, arguments.style.onnxruntime.as_deref()));
        if has_network && let Err(missing) = engine.runtime() {
            return Err(Failure::RuntimeMissing(missing.to_string()));
        }
        Ok(Self {
            names,
            registered,
            networks: PictureNetworks::new(&engine),
        })
    }

    /// The values in the order of the names.
    fn measure(&mut self, picture: &Rgb8, clean: Option<&Rgb8>) -> Result<Vec<f64>, String> {
        let values = quality::measure(picture, clean, &self.registered);
        let values = values.map_err(|error| error.to_string())?;
        let mut registered = values.into_iter().map(|(_, value)| value);
        let mut all = Vec::with_capacity(self.names.len());
        for name in &self.names {
            all.push(match name.strip_prefix(METRIC_NETWORK) {
                Some(network) => {
                    let value = self.networks.measure(network, picture);
                    value.map_err(|error| error.to_string())?
                }
                None => registered.next().ok_or("a metric has no value")?,
            });
        }
        Ok(all)
    }
}

fn list_names(arguments: &Arguments) -> Vec<String> {
    if !arguments.metrics.is_empty() {
        let names = arguments.metrics.iter().map(|name| match MetricId::parse(name) {
            Some(id) => id.to_string(),
            None => name.clone(),
        });
        return names.collect();
    }
    let mut names: Vec<String> = match &arguments.profile {
        Some(profile) => MetricId::all()
            .filter(|id: &MetricId| {
                let info = id.info();
                info.needs == Needs::Nothing && info.profile.is_none_or(|its| its.name() == profile)
            })
            .map(|id| id.to_string())
            .collect(),
        None => USUAL.map(str::to_owned).to_vec(),
    };
    if arguments.clean.is_some() {
        names.extend(COMPARING.map(str::to_owned));
    }
    names
}
