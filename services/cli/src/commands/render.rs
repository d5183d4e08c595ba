//! `fathom render`: renders a job without a service, to the same bytes.

use std::path::PathBuf;
use std::sync::Arc;

use cli::exit::Failure;
use cli::job;
use cli::progress::Progress;
use cli::styles::StyleArguments;
use renderer::Engine;

/// Options of `fathom render`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The job: a frame description with laws, as JSON
    spec: PathBuf,
    /// Folder for the frames and records.jsonl
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Frames rendered in parallel, one thread each [default: the number of cores]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    slots: Option<u16>,
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
    let engine = Arc::new(Engine::new(library, arguments.style.onnxruntime.as_deref()));
    let styles = job.styles();
    if styles.iter().any(|name| engine.library().needs_runtime(name))
        && let Err(missing) = engine.runtime()
    {
        return Err(Failure::RuntimeMissing(missing.to_string()));
    }
    let slots = arguments.slots.map_or_else(cores, usize::from);
    let mut progress = Progress::new("render", "frames", job.frames());
    let summary = renderer::local::render_job(&job, &engine, &arguments.out, slots, |finished| {
        progress.set(finished)
    });
    progress.finish();
    let summary = summary.map_err(Failure::input)?;
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

/// Number of cores.
pub(crate) fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
