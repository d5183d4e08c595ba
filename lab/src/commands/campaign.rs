//! `fathom-lab campaign`: compares random and directed frames with the bounds of their plans.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use cli::exit::Failure;
use cli::files;
use cli::progress::Progress;
use lab::campaign::{
    Family, Origin, Outcome, Studio, Summary, bound_chart, cost_chart, markdown, starts, worst,
};

use crate::{drawing, machine};

/// Options of `fathom-lab campaign`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Random frames
    #[arg(long, default_value_t = 2000, value_parser = clap::value_parser!(u64).range(0..=10_000_000))]
    frames: u64,
    /// Directed frames, each against one bound
    #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u64).range(0..=10_000_000))]
    directed: u64,
    /// Searches from the frames closest to their bounds
    #[arg(long, default_value_t = 20)]
    climbs: usize,
    /// Frames of each search
    #[arg(long, default_value_t = 10)]
    steps: usize,
    /// The first seed
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Only this family of frames: water, pictures, procedural, sequences, scatter, metering, points, defocus, lamps or lens
    #[arg(long, value_name = "NAME")]
    family: Option<String>,
    /// Folder for campaign.md, the drawings, and a job for each frame above its bound
    #[arg(long, value_name = "DIR", default_value = "campaign")]
    out: PathBuf,
}

/// Runs the command: fails if an error exceeds its bound.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let family = arguments.family.as_deref().map(parse_family).transpose()?;
    let origins = Origin::list(arguments.seed, arguments.frames, arguments.directed, family);
    let mut outcomes = run_all("frames", &origins, |origin, studio| {
        origin.run(studio).into_iter().collect()
    });
    let unrendered = origins.len() - outcomes.len();
    let climbs = starts(&outcomes, arguments.climbs);
    outcomes.extend(run_all("searches", &climbs, |climb, studio| {
        climb.run(studio, arguments.steps)
    }));
    let summary = Summary::new(&outcomes);
    let text = format!(
        "{} frames from seed {}, {unrendered} more that cannot be rendered; {}.\n\n{}",
        outcomes.len(),
        arguments.seed,
        machine::describe(),
        markdown(&outcomes)
    );
    files::write(&arguments.out.join("campaign.md"), text.as_bytes())?;
    drawing::write(&arguments.out, "campaign-bound", &bound_chart(&outcomes))?;
    if let Some(chart) = cost_chart(&outcomes) {
        drawing::write(&arguments.out, "campaign-cost", &chart)?;
    }
    write_broken(&outcomes, &arguments.out)?;
    println!("{text}");
    if summary.broken + summary.silent > 0 {
        return Err(Failure::BadInput(format!(
            "{} errors are above their bound, {} bounds above their tolerance without a reason",
            summary.broken, summary.silent
        )));
    }
    Ok(())
}

fn parse_family(name: &str) -> Result<Family, Failure> {
    Family::parse(name)
        .ok_or_else(|| Failure::BadInput(format!("`--family` is `{name}`; see --help for the families")))
}

/// Writes the worst frames above their bounds as jobs for `fathom render`.
fn write_broken(outcomes: &[Outcome], out: &Path) -> Result<(), Failure> {
    for (place, broken) in worst(outcomes, Outcome::is_broken).into_iter().enumerate() {
        let (folder, name) = (out.display().to_string(), format!("above-{place}"));
        for (name, bytes) in broken.origin.case().files(&folder, &name) {
            files::write(&out.join(name), &bytes)?;
        }
    }
    Ok(())
}

/// Runs tasks on all cores. The outcomes are in the order of the tasks.
fn run_all<T: Sync>(
    unit: &str,
    tasks: &[T],
    run: impl Fn(&T, &mut Studio) -> Vec<Outcome> + Sync,
) -> Vec<Outcome> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let next = AtomicUsize::new(0);
    let mut progress = Progress::new("campaign", unit, tasks.len() as u64);
    let mut done: Vec<(usize, Vec<Outcome>)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|_| scope.spawn(|| run_next(tasks, &next, &run)))
            .collect();
        while workers.iter().any(|worker| !worker.is_finished()) {
            std::thread::sleep(std::time::Duration::from_millis(100));
            progress.set(next.load(Ordering::Relaxed).min(tasks.len()) as u64);
        }
        let finished = workers
            .into_iter()
            .map(|worker| worker.join().expect("a frame does not panic"));
        finished.flatten().collect()
    });
    progress.finish();
    done.sort_by_key(|(number, _)| *number);
    done.into_iter().flat_map(|(_, outcomes)| outcomes).collect()
}

/// Runs the remaining tasks one after the other.
fn run_next<T>(
    tasks: &[T],
    next: &AtomicUsize,
    run: impl Fn(&T, &mut Studio) -> Vec<Outcome>,
) -> Vec<(usize, Vec<Outcome>)> {
    let (mut done, mut studio) = (Vec::new(), Studio::new());
    loop {
        let number = next.fetch_add(1, Ordering::Relaxed);
        let Some(task) = tasks.get(number) else {
            return done;
        };
        done.push((number, run(task, &mut studio)));
    }
}
