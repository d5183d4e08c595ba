//! `fathom-lab truth`: traces one frame of a job by Monte Carlo and compares it with the chain.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use anyhow::Context;
use clap::ValueEnum;
use cli::exit::Failure;
use cli::progress::Progress;
use cli::{files, job};
use imaging::codec;
use lab::frame_truth::round;
use renderer::{Traced, Tracing};
use serde_json::json;
use spec::{Frame, PhaseFunction};
use truth::{Goal, PhaseModel};

use crate::studio::Studio;

/// Options of `fathom-lab truth`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The job: a frame description with distributions, as JSON
    spec: PathBuf,
    /// Index of the frame
    #[arg(long, default_value_t = 0)]
    frame: u64,
    /// Folder for truth.npy, truth_error.npy and truth_report.json
    #[arg(long, value_name = "DIR", default_value = "truth")]
    out: PathBuf,
    /// Error of the median block as a share of the frame's mean
    #[arg(long, default_value_t = 0.02, value_parser = target)]
    target: f64,
    /// Maximum paths of each pixel and channel
    #[arg(long, default_value_t = 1 << 16, value_parser = clap::value_parser!(u64).range(1 << 4..=1 << 20))]
    paths_max: u64,
    /// Side of the compared blocks, pixels
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u16).range(1..=64))]
    block: u16,
    /// Stop before a round that would end after this time; lifts the limit of 65536 pixels times 65536 paths
    #[arg(long)]
    budget_s: Option<u64>,
    /// Seed of the paths [default: the job's]
    #[arg(long)]
    seed: Option<u64>,
    /// Phase function, scaled to the backscatter fraction [default: the job's `water.optics.phase`]
    #[arg(long, value_enum)]
    phase: Option<Kind>,
    /// Trace all channels on one path, for attenuations within a factor of 3
    #[arg(long)]
    shared: bool,
}

/// Phase functions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Fournier-Forand with the water's backscatter fraction
    Ff,
    /// Henyey-Greenstein with the water's backscatter fraction
    Hg,
}

/// Maximum of pixels times paths without a budget.
const MOST_WORK: u64 = 1 << 32;

fn target(text: &str) -> Result<f64, String> {
    let limits = 0.001..=0.5;
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if limits.contains(&value) {
        Ok(value)
    } else {
        Err("the limit is 0.001..=0.5".to_owned())
    }
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut studio = Studio::with_shipped_styles()?;
    let job = job::read(&arguments.spec, &studio.library)?;
    let frame = job
        .resolve(arguments.frame)
        .map_err(|invalid| job::refused(&arguments.spec, &invalid))?;
    let chain = studio.water_light(&frame, false)?;
    let (width, height) = chain.setting.size;
    let pixels = (width * height) as u64;
    if arguments.budget_s.is_none() && pixels.saturating_mul(arguments.paths_max) > MOST_WORK {
        return Err(Failure::BadInput(format!(
            "{width}×{height} pixels with --paths-max {} are {} paths, the limit is {MOST_WORK} without --budget-s",
            arguments.paths_max,
            pixels * arguments.paths_max
        )));
    }
    let law = match arguments.phase {
        Some(Kind::Ff) => PhaseModel::of_water(PhaseFunction::Ff, chain.setting.water.as_ref()),
        Some(Kind::Hg) => PhaseModel::of_water(PhaseFunction::Hg, chain.setting.water.as_ref()),
        None => chain.law,
    };
    let tracing = Tracing {
        goal: Goal {
            target: arguments.target,
            block: usize::from(arguments.block),
            most_paths: arguments.paths_max,
        },
        law,
        seed: arguments.seed.unwrap_or(frame.seed),
        is_shared: arguments.shared,
        limit: if arguments.budget_s.is_some() {
            "paths_max or budget_s"
        } else {
            "paths_max"
        },
    };
    let start = Instant::now();
    let found = traced(arguments, &frame, &mut studio, &tracing, pixels)?;
    write(arguments, &found, start.elapsed())
}

/// Traces a frame with a progress bar for the pixels of each round.
fn traced(
    arguments: &Arguments,
    frame: &Frame,
    studio: &mut Studio,
    tracing: &Tracing,
    pixels: u64,
) -> Result<Traced, Failure> {
    let start = Instant::now();
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut progress = Progress::new("truth", "pixels", pixels);
    let found = studio.trace(frame, tracing, &mut |shutter, scene, samples| {
        progress.set_with(0, format!("pixels, paths {} to {}", samples.start, samples.end));
        // The next round costs as much as all earlier rounds together.
        let ends = 2 * start.elapsed();
        let is_in_time = arguments
            .budget_s
            .is_none_or(|budget| samples.start == 0 || ends <= Duration::from_secs(budget));
        is_in_time.then(|| {
            round(
                (shutter, scene),
                pixels as usize,
                samples,
                threads,
                &mut |pixels| {
                    progress.set(pixels as u64);
                },
            )
        })
    });
    progress.finish();
    found?.ok_or_else(|| {
        Failure::BadInput("scene: it has no range, without which there is no water before it".to_owned())
    })
}

fn write(arguments: &Arguments, found: &Traced, took: Duration) -> Result<(), Failure> {
    let [mean, error] = found.truth.pictures();
    let mut report = json!(found.report);
    report["seconds"] = json!(took.as_secs_f64());
    let text = serde_json::to_string_pretty(&report).context("cannot write the report")?;
    let path = |name: &str| arguments.out.join(name);
    files::write(&path("truth.npy"), &codec::encode_npy_rgb(&mean))?;
    files::write(&path("truth_error.npy"), &codec::encode_npy_rgb(&error))?;
    files::write(&path("truth_report.json"), text.as_bytes())?;
    println!("{text}");
    Ok(())
}
