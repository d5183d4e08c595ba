//! `fathom-lab truth-lamps`: compares the light of lamps in six waters with Monte Carlo.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};

use cli::exit::Failure;
use cli::files;
use cli::progress::Progress;
use lab::lamp_truth::{CONES_DEG, Cell, LAWS, Task, WATERS, csv, markdown, measure};

use crate::machine;

/// Options of `fathom-lab truth-lamps`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Photons of each lamp in water with b of 0.5 per meter and more; clearer water needs up to ten times as many
    #[arg(long, default_value_t = 400_000, value_parser = clap::value_parser!(u64).range(1_600..=1_000_000_000))]
    photons: u64,
    /// Folder for lamps.md and lamps.csv
    #[arg(long, value_name = "DIR", default_value = "target/docs")]
    out: PathBuf,
}

/// Water with a smaller scattering coefficient needs more photons, 1/m.
const THICK: f64 = 0.5;

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    // Clear water first, because it is slowest.
    let lamps = (0..WATERS.len()).flat_map(|water| CONES_DEG.map(|cone_deg| (water, cone_deg)));
    let task = |(water, cone_deg)| LAWS.map(|law| Task { water, cone_deg, law });
    let tasks: Vec<Task> = lamps.flat_map(task).collect();
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let next = AtomicU64::new(0);
    let mut progress = Progress::new("truth-lamps", "lamps", tasks.len() as u64);
    let mut found: Vec<(usize, Vec<Cell>)> = std::thread::scope(|scope| {
        let work = || {
            let mut found = Vec::new();
            loop {
                let number = next.fetch_add(1, Ordering::Relaxed) as usize;
                let Some(&task) = tasks.get(number) else {
                    return found;
                };
                let more = (THICK / WATERS[task.water].1.scattering).clamp(1.0, 10.0);
                let photons = (arguments.photons as f64 * more) as u64;
                found.push((number, measure(task, 0..photons)));
            }
        };
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        while workers.iter().any(|worker| !worker.is_finished()) {
            std::thread::sleep(std::time::Duration::from_millis(100));
            progress.set(next.load(Ordering::Relaxed).min(tasks.len() as u64));
        }
        let finished = workers.into_iter().filter_map(|worker| worker.join().ok());
        finished.flatten().collect()
    });
    progress.finish();
    found.sort_by_key(|(number, _)| *number);
    let cells: Vec<Cell> = found.into_iter().flat_map(|(_, cells)| cells).collect();
    let text = format!(
        "# Lamps, by Monte Carlo\n\nMade by `fathom-lab truth-lamps --photons {}`; {}.\n\n{}",
        arguments.photons,
        machine::describe(),
        markdown(&cells)
    );
    files::write(&arguments.out.join("lamps.md"), text.as_bytes())?;
    files::write(&arguments.out.join("lamps.csv"), csv(&cells).as_bytes())?;
    println!("{text}");
    Ok(())
}
