//! `fathom-lab campaign`: random frames against the promise of the plan.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};

use cli::exit::Failure;
use cli::files;
use cli::progress::Progress;
use lab::campaign::{Outcome, Summary, bound_chart, case, cost_chart, markdown, run as measure};

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
            let mut outcomes = Vec::new();
            loop {
                let number = next.fetch_add(1, Ordering::Relaxed);
                if number >= arguments.scenes {
                    return outcomes;
                }
                outcomes.extend(measure(&case(arguments.seed.wrapping_add(number))));
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
    match Summary::of(&outcomes).broken {
        0 => Ok(()),
        broken => Err(Failure::BadInput(format!(
            "{broken} errors are above their bound"
        ))),
    }
}
