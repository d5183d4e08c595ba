//! `fathom-lab campaign`: random frames against the promise of the plan.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};

use cli::exit::Failure;
use cli::files;
use cli::progress::Progress;
use lab::campaign::{Outcome, Studio, Summary, bound_chart, cost_chart, markdown, run as measure};

use crate::{drawing, machine};

/// Options of `fathom-lab campaign`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Frames to try
    #[arg(long, default_value_t = 10_000, value_parser = clap::value_parser!(u64).range(1..=10_000_000))]
    scenes: u64,
    /// The first seed
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Folder for campaign.md and the drawings
    #[arg(long, value_name = "DIR", default_value = "campaign")]
    out: PathBuf,
}

/// Runs the command: fails if an error exceeds its bound.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let next = AtomicU64::new(0);
    let mut progress = Progress::new("campaign", "frames", arguments.scenes);
    let mut outcomes: Vec<Outcome> = std::thread::scope(|scope| {
        let work = || {
            let (mut outcomes, mut studio) = (Vec::new(), Studio::new());
            loop {
                let number = next.fetch_add(1, Ordering::Relaxed);
                if number >= arguments.scenes {
                    return outcomes;
                }
                outcomes.extend(measure(arguments.seed.wrapping_add(number), &mut studio));
            }
        };
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        while workers.iter().any(|worker| !worker.is_finished()) {
            std::thread::sleep(std::time::Duration::from_millis(100));
            progress.set(next.load(Ordering::Relaxed).min(arguments.scenes));
        }
        let finished = workers.into_iter().filter_map(|worker| worker.join().ok());
        finished.flatten().collect()
    });
    progress.finish();
    outcomes.sort_by_key(|outcome| (outcome.seed, outcome.channel));
    let text = format!(
        "{} frames; {}.\n\n{}",
        arguments.scenes,
        machine::describe(),
        markdown(&outcomes)
    );
    files::write(&arguments.out.join("campaign.md"), text.as_bytes())?;
    drawing::write(&arguments.out, "campaign-bound", &bound_chart(&outcomes))?;
    drawing::write(&arguments.out, "campaign-cost", &cost_chart(&outcomes))?;
    println!("{text}");
    let summary = Summary::new(&outcomes);
    if summary.broken + summary.silent > 0 {
        return Err(Failure::BadInput(format!(
            "{} errors are above their bound, {} bounds above their tolerance without a reason",
            summary.broken, summary.silent
        )));
    }
    Ok(())
}
