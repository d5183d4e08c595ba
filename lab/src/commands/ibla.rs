//! `fathom-lab ibla`: how often the faster variants of IBLA find the light of the exact one, and how far their results differ.

use std::path::PathBuf;

use anyhow::Context;
use cli::exit::Failure;
use cli::progress::Progress;
use lab::ibla::{compare, markdown};
use serde_json::{Value, json};

use crate::studio::{Studio, raster};

/// Options of `fathom-lab ibla`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Job descriptions
    #[arg(required = true)]
    jobs: Vec<PathBuf>,
    /// Frames of each job
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    frames: u64,
    /// Columns of the frames; rows follow as 565 to 869
    #[arg(long, default_value_t = 869, value_parser = clap::value_parser!(u64).range(16..=4096))]
    width: u64,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut studio = Studio::with_shipped_styles()?;
    let mut progress = Progress::new("ibla", "frames", arguments.frames * arguments.jobs.len() as u64);
    let mut outcomes = Vec::new();
    for path in &arguments.jobs {
        let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
        let mut job: Value = serde_json::from_str(&text).with_context(|| path.display().to_string())?;
        for (key, value) in [
            ("artifacts", json!(["rgb"])),
            ("count", json!(arguments.frames)),
            ("enhance", json!([])),
            ("metrics", json!([])),
        ] {
            job[key] = value;
        }
        // The light is estimated before a style, which would need ONNX Runtime.
        if let Some(water) = job["water"].as_object_mut() {
            water.remove("style");
        }
        job["camera"]["width"] = json!(arguments.width);
        job["camera"]["height"] = json!((arguments.width * 565 / 869).max(1));
        for index in 0..arguments.frames {
            let frame = studio.frame(&job, index)?;
            let picture = raster(&studio.render(&frame)?, "rgb")?.to_rgb8();
            outcomes.extend(compare(&picture).map_err(anyhow::Error::from)?);
            progress.set(outcomes.len() as u64 / 3);
        }
    }
    progress.finish();
    print!("{}", markdown(&outcomes));
    Ok(())
}
