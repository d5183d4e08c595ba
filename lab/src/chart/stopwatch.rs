//! Times of repeated runs.

use std::time::Instant;

/// Milliseconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Times {
    /// Median run.
    pub median: f64,
    /// The fastest run.
    pub min: f64,
    /// The slowest.
    pub max: f64,
}

/// Measures the run time of `work`, ms.
pub fn time_once<R>(work: impl FnOnce() -> R) -> f64 {
    let start = Instant::now();
    std::hint::black_box(work());
    start.elapsed().as_secs_f64() * 1e3
}

/// Slower work is run only a few times.
const SLOW_MS: f64 = 400.0;
const SLOW_RUNS: usize = 3;

/// Runs `work` once to warm up and then `runs` times; slow work is not warmed up. Returns the result of the last run.
pub fn time<R>(runs: usize, mut work: impl FnMut() -> R) -> (Times, R) {
    let mut timed = || {
        let start = Instant::now();
        let answer = work();
        (start.elapsed().as_secs_f64() * 1e3, answer)
    };
    let (first, mut answer) = timed();
    let (mut all, runs) = if first > SLOW_MS {
        (vec![first], runs.min(SLOW_RUNS))
    } else {
        (Vec::with_capacity(runs), runs.max(1))
    };
    for _ in all.len()..runs {
        let (ms, last) = timed();
        all.push(ms);
        answer = last;
    }
    all.sort_by(f64::total_cmp);
    let times = Times {
        median: all[all.len() / 2],
        min: all[0],
        max: all[all.len() - 1],
    };
    (times, answer)
}
