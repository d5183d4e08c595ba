//! `fathom plan`: how a frame would be rendered, and the error bound of each stage.

use std::path::PathBuf;
use std::sync::Arc;

use cli::exit::Failure;
use cli::job;
use cli::styles::StyleArguments;
use cli::table::table_of;
use renderer::{Engine, SceneSource, Slot};
use serde_json::{Value, json};

/// Options of `fathom plan`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The job: a frame description with laws, as JSON
    spec: PathBuf,
    /// Index of the frame
    #[arg(long, default_value_t = 0)]
    frame: u64,
    /// Print the plan as JSON, as stored with the image
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    style: StyleArguments,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let library = arguments.style.library()?;
    let job = job::read(&arguments.spec, &library)?;
    for warning in job.warnings() {
        eprintln!("warning: {warning}");
    }
    if arguments.frame >= job.frames() {
        let (frame, frames) = (arguments.frame, job.frames());
        let message = format!(
            "--frame {frame} is beyond the job's {frames} frames, 0 to {}",
            frames - 1
        );
        return Err(Failure::BadInput(message));
    }
    let frame = job
        .resolve(arguments.frame)
        .map_err(|invalid| job::refused(&arguments.spec, &invalid))?;
    let engine = Arc::new(Engine::new(library, arguments.style.onnxruntime.as_deref()));
    let plan = Slot::new(&engine)
        .plan(&frame, &SceneSource::Local)
        .map_err(Failure::input)?;
    if arguments.json {
        println!("{}", json!(plan));
        return Ok(());
    }
    let columns = ["stage", "variant", "terms", "share", "bound", "cost_ms", "note"];
    let lines: Vec<Value> = plan.lines().iter().map(|line| json!(line)).collect();
    println!("{}", table_of(&columns, &lines));
    for line in plan.lines() {
        if let Some(error) = &line.model_error {
            println!("Model error of {}: {error}", line.stage);
        }
    }
    if let Some(bounds) = plan.water.bounds() {
        let largest = bounds.into_iter().fold(0.0, f64::max);
        println!("Every sample before the style is within {largest:.2e} in linear light of the exact chain.");
    }
    Ok(())
}
