//! `fathom render`: renders a job without a service, to the same bytes.

use cli::exit::Failure;
use cli::plural::count;
use cli::progress::Progress;
use cli::render::Arguments;
use renderer::local::LocalError;

use crate::commands::sharded;

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.wants_set() {
        return sharded::render::run(arguments);
    }
    let (job, engine) = arguments.prepare()?;
    let slots = arguments.slots();
    let frames = arguments.range(&job)?;
    let mut progress = Progress::new("render", "frames", frames.end - frames.start);
    let summary = renderer::local::render_job(&job, &engine, &arguments.out, frames, slots, |finished| {
        progress.set(finished)
    });
    progress.finish();
    let summary = summary.map_err(|error| match error {
        LocalError::Taken { .. } => Failure::Later(error.to_string()),
        _ => Failure::input(error),
    })?;
    println!(
        "{} in {:.1} s ({:.2} frames/s) in {}",
        count(summary.frames, "frame"),
        summary.elapsed.as_secs_f64(),
        (summary.frames - summary.kept) as f64 / summary.elapsed.as_secs_f64().max(1e-9),
        arguments.out.display()
    );
    println!("digest {}", summary.digest);
    for (warning, frames) in &summary.warnings {
        eprintln!("warning: {frames} of {} frames: {warning}", summary.frames);
    }
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
