//! One frame of a job by Monte Carlo, compared with the chain.

use std::time::{Duration, Instant};

use anyhow::Context;
use cli::exit::Failure;
use imaging::codec;
use renderer::{SceneSource, Traced, Tracing};
use serde_json::{Value, json};
use spec::PhaseFunction;
use truth::{Goal, PhaseModel};

use crate::parallel::run_all;
use crate::report::Report;
use crate::row;
use crate::setup::{Parameter, Setup};
use crate::studio::{Studio, read_json};
use crate::table::Table;

/// The parameters of a trace.
pub const PARAMETERS: &[Parameter] = &[
    Parameter::number("frame", "0", [0.0, 1e9], "index of the frame"),
    Parameter::number(
        "target",
        "0.02",
        [0.001, 0.5],
        "error of the median block as a share of the frame's mean",
    ),
    Parameter::number(
        "paths_max",
        "65536",
        [16.0, 1_048_576.0],
        "maximum paths of each pixel and channel",
    ),
    Parameter::number("block", "8", [1.0, 64.0], "side of the compared blocks, pixels"),
    Parameter::number(
        "budget_s",
        "",
        [1.0, 1e7],
        "stop before a round that would end after this time",
    ),
    Parameter::number("seed", "", [0.0, 1e15], "seed of the paths; without it the job's"),
    Parameter::text("phase", "phase function, `ff` or `hg`; without it the job's"),
    Parameter::text(
        "shared",
        "`yes` traces all channels on one path, for attenuations within a factor of 3",
    ),
];
/// Maximum of pixels times paths without a budget.
const MOST_WORK: f64 = (1u64 << 32) as f64;
/// Pixels that a thread claims at a time.
const PIXELS: usize = 16;

/// Traces a frame on all cores. The files are `truth.npy`, `truth_error.npy` and `truth_report.json`.
///
/// # Errors
/// The job is invalid, too large without a budget, or has no range.
pub fn run(setup: &Setup) -> Result<Report, Failure> {
    let path = &setup.required_inputs("a job")?[0];
    let mut studio = Studio::new(&setup.styles)?;
    let frame = studio.frame(&read_json(path)?, setup.number("frame") as u64)?;
    let chain = studio
        .slot
        .water_light(&frame, &SceneSource::Local, false)
        .map_err(Failure::input)?;
    let (width, height) = chain.setting.size;
    let (pixels, most_paths) = (width * height, setup.number("paths_max"));
    let budget = setup.optional_number("budget_s").map(Duration::from_secs_f64);
    if budget.is_none() && pixels as f64 * most_paths > MOST_WORK {
        return Err(Failure::BadInput(format!(
            "{width}×{height} pixels with `paths_max` {most_paths} are {} paths; at most {MOST_WORK} without `budget_s`",
            pixels as f64 * most_paths
        )));
    }
    let water = chain.setting.water.as_ref();
    let law = match setup.text("phase") {
        Some("ff") => PhaseModel::of_water(PhaseFunction::Ff, water),
        Some("hg") => PhaseModel::of_water(PhaseFunction::Hg, water),
        Some(other) => return Err(Failure::BadInput(format!("`phase` is {other}; must be ff or hg"))),
        None => chain.law,
    };
    let tracing = Tracing {
        goal: Goal {
            target: setup.number("target"),
            block: setup.count("block"),
            most_paths: most_paths as u64,
        },
        law,
        seed: setup
            .optional_number("seed")
            .map_or(frame.seed, |seed| seed as u64),
        is_shared: setup.text("shared") == Some("yes"),
        limit: if budget.is_some() {
            "paths_max or budget_s"
        } else {
            "paths_max"
        },
    };
    let chunks: Vec<_> = (0..pixels)
        .step_by(PIXELS)
        .map(|first| first..(first + PIXELS).min(pixels))
        .collect();
    let start = Instant::now();
    let traced = studio
        .slot
        .trace(
            &frame,
            &SceneSource::Local,
            &tracing,
            &mut |shutter, scene, samples| {
                // The next round costs as much as all earlier rounds together.
                let ends = 2 * start.elapsed();
                let is_in_time = budget.is_none_or(|budget| samples.start == 0 || ends <= budget);
                is_in_time.then(|| {
                    let unit = format!("pieces, paths {} to {}", samples.start, samples.end);
                    let parts = run_all(
                        &unit,
                        None,
                        &chunks,
                        || (),
                        |pixels, ()| shutter.trace(scene, pixels.clone(), samples),
                    );
                    parts.concat()
                })
            },
        )
        .map_err(Failure::input)?;
    let traced =
        traced.ok_or_else(|| Failure::input("scene: it has no range, so no water in front of it"))?;
    report(&traced, start.elapsed())
}

fn report(traced: &Traced, took: Duration) -> Result<Report, Failure> {
    let [mean, error] = traced.truth.pictures();
    let mut details = json!(traced.report);
    details["seconds"] = json!(took.as_secs_f64());
    let columns = [
        "light",
        "blocks",
        "channel",
        "truth",
        "chain",
        "relative bias",
        "relative rms",
    ];
    let mut table = Table::new("chain against truth", columns);
    for light in ["unscattered", "scattered", "all"] {
        for blocks in ["smooth", "edges"] {
            let channels: Option<&Vec<Value>> = details["chain"][light][blocks].as_array();
            for (channel, found) in ["red", "green", "blue"]
                .iter()
                .zip(channels.into_iter().flatten())
            {
                table.push(row![
                    light,
                    blocks,
                    channel,
                    found["truth"],
                    found["model"],
                    found["relative_bias"],
                    found["relative_rms"]
                ]);
            }
        }
    }
    let about = format!(
        "{} paths of each pixel; ended by {}.",
        details["paths"], details["ended_by"]
    );
    let text = serde_json::to_vec_pretty(&details).context("the report as JSON")?;
    Ok(Report {
        files: vec![
            ("truth.npy".to_owned(), codec::encode_npy_rgb(&mean)),
            ("truth_error.npy".to_owned(), codec::encode_npy_rgb(&error)),
            ("truth_report.json".to_owned(), text),
        ],
        ..Report::new(about, vec![table])
    })
}
