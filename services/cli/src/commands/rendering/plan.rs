//! `fathom plan`: how a frame would be rendered, and the error bound of each stage.

use std::path::PathBuf;
use std::sync::Arc;

use cli::exit::Failure;
use cli::job;
use cli::styles::StyleArguments;
use cli::table::{cell, table};
use renderer::{Engine, SceneSource, Slot};
use serde_json::json;

/// Options of `fathom plan`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The job: a frame description as JSON, with random distributions
    spec: PathBuf,
    /// Index of the frame
    #[arg(long, default_value_t = 0)]
    frame: u64,
    /// Print the plan and its promise as JSON, as stored with the image
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
    let promise = plan.promise();
    if arguments.json {
        println!("{}", json!({"plan": plan, "promise": promise}));
        return Ok(());
    }
    let columns = [
        "stage", "variant", "terms", "share", "bound", "gain", "cost_ms", "note",
    ];
    let rows = plan.stages.iter().map(|stage| {
        let stage = json!(stage);
        columns.map(|column| cell(&stage[column])).to_vec()
    });
    println!("{}", table(&columns, &rows.collect::<Vec<_>>()));
    for stage in &plan.stages {
        if let Some(error) = stage.printed_model_error() {
            println!("Model error of {}: {error}", stage.id.name());
        }
    }
    if let Some(promise) = promise {
        println!("{}", promise.text);
        if let Some(reason) = promise.exceeds {
            eprintln!("warning: the plan exceeds the tolerance: {reason}");
        }
    }
    Ok(())
}
