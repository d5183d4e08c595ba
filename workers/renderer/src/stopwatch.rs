//! Milliseconds per stage.

use std::collections::BTreeMap;
use std::time::Instant;

/// Times the stages of one frame.
pub(crate) struct Stopwatch {
    start: Instant,
    stages: BTreeMap<String, f64>,
}

impl Stopwatch {
    pub(crate) fn start() -> Self {
        Self {
            start: Instant::now(),
            stages: BTreeMap::new(),
        }
    }

    /// Runs a stage and adds its time under this name.
    pub(crate) fn time<T>(&mut self, stage: &str, run: impl FnOnce() -> T) -> T {
        let begun = Instant::now();
        let value = run();
        *self.stages.entry(stage.to_owned()).or_default() += milliseconds(begun);
        value
    }

    /// As [`Self::time`], but records no time if the frame lacks the stage.
    pub(crate) fn time_if<T>(&mut self, is_used: bool, stage: &str, run: impl FnOnce() -> T) -> T {
        if is_used { self.time(stage, run) } else { run() }
    }

    /// All stages and `total`.
    pub(crate) fn stop(mut self) -> BTreeMap<String, f64> {
        self.stages.insert("total".to_owned(), milliseconds(self.start));
        self.stages
    }
}

fn milliseconds(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1000.0
}
