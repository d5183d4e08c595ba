//! `fathom plan`: how a frame would be rendered, and the error bound of each stage.

use std::path::PathBuf;
use std::sync::Arc;

use cli::exit::Failure;
use cli::job;
use cli::styles::StyleArguments;
use cli::table::{cell, table};
use cli::terminal::text_width;
use cli::wrap::paragraph;
use optics::plan::Stage;
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
    let columns = ["stage", "variant", "terms", "bound", "gain", "cost_ms"];
    let rows = plan.stages.iter().map(|stage| {
        let printed = json!(stage);
        let mut row = columns.map(|column| cell(&printed[column]));
        if stage.relative_share > 0.0 {
            row[3] = format!("{} + {:.2} %", row[3], 100.0 * stage.relative_share);
        }
        row.to_vec()
    });
    println!("{}", table(&columns, &rows.collect::<Vec<_>>()));
    let of_stages = |text: fn(&Stage) -> Option<String>| {
        let texts = plan
            .stages
            .iter()
            .filter_map(move |stage| Some((stage.id.name(), text(stage)?)));
        join_stages(texts)
    };
    print_remarks("Notes", &of_stages(|stage| stage.note.clone()));
    print_remarks("Model errors", &of_stages(Stage::printed_model_error));
    if let Some(promise) = promise {
        println!("\n{}", paragraph(&promise.text, 0, text_width()));
        if let Some(reason) = promise.exceeds {
            eprintln!("warning: the plan exceeds the tolerance: {reason}");
        }
    }
    Ok(())
}

/// A remark about some stages.
#[derive(Debug, PartialEq)]
struct Remark {
    stages: Vec<&'static str>,
    text: String,
}

/// Remarks in the order of stages; those with the same text are one.
fn join_stages(texts: impl Iterator<Item = (&'static str, String)>) -> Vec<Remark> {
    let mut remarks: Vec<Remark> = Vec::new();
    for (stage, text) in texts {
        match remarks.iter_mut().find(|remark| remark.text == text) {
            Some(remark) => remark.stages.push(stage),
            None => remarks.push(Remark {
                stages: vec![stage],
                text,
            }),
        }
    }
    remarks
}

fn print_remarks(title: &str, remarks: &[Remark]) {
    if remarks.is_empty() {
        return;
    }
    println!("\n{title}:");
    for Remark { stages, text } in remarks {
        let remark = format!("  {}: {text}", stages.join(", "));
        println!("{}", paragraph(&remark, 4, text_width()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_with_one_remark_share_a_line() {
        let texts = [("a", "x"), ("b", "y"), ("c", "x")].map(|(stage, text)| (stage, text.to_owned()));
        let remarks = join_stages(texts.into_iter());
        assert_eq!((remarks.len(), &remarks[0].stages), (2, &vec!["a", "c"]));
    }
}
