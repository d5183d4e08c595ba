//! Tasks on all cores. The results do not depend on the number of threads.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use cli::progress::Progress;

/// Runs tasks on a number of threads (`None`: all cores), each with its state. The results are in the order of the tasks.
///
/// # Panics
/// A task panics.
pub fn run_all<T: Sync, S, R: Send>(
    unit: &str,
    threads: Option<usize>,
    tasks: &[T],
    make_state: impl Fn() -> S + Sync,
    run: impl Fn(&T, &mut S) -> R + Sync,
) -> Vec<R> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = threads.unwrap_or(cores);
    let next = AtomicUsize::new(0);
    let mut progress = Progress::new("experiment", unit, tasks.len() as u64);
    let mut done: Vec<(usize, R)> = std::thread::scope(|scope| {
        let mut workers = Vec::new();
        for _ in 0..threads {
            workers.push(scope.spawn(|| {
                let (mut done, mut state) = (Vec::new(), make_state());
                loop {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    let Some(task) = tasks.get(number) else {
                        return done;
                    };
                    done.push((number, run(task, &mut state)));
                }
            }));
        }
        while workers.iter().any(|worker| !worker.is_finished()) {
            std::thread::sleep(Duration::from_millis(20));
            progress.set(next.load(Ordering::Relaxed).min(tasks.len()) as u64);
        }
        let joined = workers.into_iter().map(std::thread::ScopedJoinHandle::join);
        joined
            .flat_map(|done| done.expect("a task does not panic"))
            .collect()
    });
    progress.finish();
    done.sort_by_key(|(number, _)| *number);
    done.into_iter().map(|(_, result)| result).collect()
}
