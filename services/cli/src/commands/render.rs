//! `fathom render`: a job without a service; the same frames, byte for byte.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use renderer::Engine;
use spec::Job;
use style::Library;

use super::StyleArguments;
use crate::exit::Failure;
use crate::files;
use crate::progress::Progress;

/// Options of `fathom render`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The job: a frame description with laws, as JSON
    spec: PathBuf,
    /// Folder for the frames and records.jsonl
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Frames rendered side by side, one thread each [default: the machine's cores]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    slots: Option<u16>,
    #[command(flatten)]
    style: StyleArguments,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let library = super::styles::library(&arguments.style)?;
    let job = read_job(&arguments.spec, &library)?;
    for warning in job.warnings() {
        eprintln!("warning: {warning}");
    }
    let engine = Arc::new(Engine::new(library, arguments.style.onnxruntime.as_deref()));
    let styles = job.styles();
    if styles.iter().any(|name| engine.library().needs_runtime(name))
        && let Err(missing) = engine.runtime()
    {
        return Err(Failure::RuntimeMissing(missing.to_string()));
    }
    let slots = arguments.slots.map_or_else(cores, usize::from);
    let mut progress = Progress::new("render", job.frames());
    let summary = renderer::local::render_job(&job, &engine, &arguments.out, slots, |finished| {
        progress.set(finished)
    });
    progress.finish();
    let summary = summary.map_err(|error| Failure::BadInput(error.to_string()))?;
    println!(
        "{} frames in {:.1} s ({:.2} frames/s) in {}",
        summary.frames,
        summary.elapsed.as_secs_f64(),
        summary.frames as f64 / summary.elapsed.as_secs_f64().max(1e-9),
        arguments.out.display()
    );
    println!("digest {}", summary.digest);
    if summary.failed > 0 {
        let hint = format!("; see {}", arguments.out.join("errors.jsonl").display());
        return Err(Failure::SomeFrames {
            failed: summary.failed,
            frames: summary.frames,
            hint,
        });
    }
    Ok(())
}

/// Reads a job that may name files of this machine.
pub(crate) fn read_job(path: &Path, library: &Library) -> Result<Job, Failure> {
    let text = files::read(path)?;
    Job::parse(&text, &renderer::vocabulary(library, true)).map_err(|invalid| bad_spec(path, &invalid))
}

/// The machine's cores.
pub(crate) fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Every error of a job description, one per line.
pub(crate) fn bad_spec(path: &Path, invalid: &spec::Invalid) -> Failure {
    let mut message = format!("{}: {} errors", path.display(), invalid.0.len());
    for error in &invalid.0 {
        message.push_str(&format!("\n  {} {}", error.pointer, error.message));
        if let Some(near) = &error.did_you_mean {
            message.push_str(&format!(" (did you mean `{near}`?)"));
        }
    }
    Failure::BadInput(message)
}
