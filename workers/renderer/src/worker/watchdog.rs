//! Ends the process when a frame runs without end or eats the machine's memory: nothing inside a process can stop a
//! thread that computes, and the service knows how to go on after a worker that died.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::Shared;
use super::memory::resident_bytes;

/// How often the frames and the memory are looked at.
const LOOK: Duration = Duration::from_millis(100);

/// What a frame may cost before the worker gives itself up.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Longest time of one frame.
    pub frame: Duration,
    /// Most resident memory of the whole worker, bytes.
    pub memory_bytes: u64,
}

impl Limits {
    /// No limit: for a worker that shares its process with its supervisor.
    pub const NONE: Self = Self {
        frame: Duration::MAX,
        memory_bytes: u64::MAX,
    };
}

/// The frames that are being rendered, by slot.
#[derive(Default)]
pub(crate) struct Running(Mutex<BTreeMap<usize, Frame>>);

#[derive(Clone)]
struct Frame {
    job: String,
    frame: u64,
    begun: Instant,
}

impl Running {
    pub(crate) fn begin(&self, slot: usize, job: &str, frame: u64) {
        let begun = Instant::now();
        let job = job.to_owned();
        self.map().insert(slot, Frame { job, frame, begun });
    }

    pub(crate) fn end(&self, slot: usize) {
        self.map().remove(&slot);
    }

    /// Why the process must end, if it must.
    fn verdict(&self, limits: &Limits, memory_bytes: Option<u64>) -> Option<String> {
        let running = self.map();
        if let Some(late) = running
            .values()
            .find(|frame| frame.begun.elapsed() > limits.frame)
        {
            let Frame { job, frame, .. } = late;
            let limit = limits.frame.as_secs_f64();
            return Some(format!(
                "frame {frame} of {job} took more than {limit} s (--frame-limit-s)"
            ));
        }
        let memory = memory_bytes.filter(|&bytes| bytes > limits.memory_bytes)?;
        let frames: Vec<String> = running
            .values()
            .map(|f| format!("{} of {}", f.frame, f.job))
            .collect();
        Some(format!(
            "the worker takes {} MiB and may take {} (--memory-limit-mib) while it renders frames: {}",
            memory >> 20,
            limits.memory_bytes >> 20,
            frames.join(", ")
        ))
    }

    fn map(&self) -> MutexGuard<'_, BTreeMap<usize, Frame>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Watches until the worker is to stop.
pub(crate) fn run(shared: &Shared) {
    while !shared.stop.is_set() {
        if let Some(verdict) = shared.running.verdict(&shared.limits, resident_bytes()) {
            tracing::error!("{verdict}; the worker ends itself");
            std::process::abort();
        }
        shared.stop.pause(LOOK);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_within_its_limits_goes_on_and_what_is_not_is_named() {
        let running = Running::default();
        let limits = Limits {
            frame: Duration::from_millis(5),
            memory_bytes: 100 << 20,
        };
        assert_eq!(running.verdict(&limits, Some(100 << 20)), None);
        running.begin(0, "job_a", 7);
        assert_eq!(running.verdict(&limits, None), None);
        let greedy = running.verdict(&limits, Some(101 << 20)).unwrap();
        assert!(
            greedy.contains("101 MiB") && greedy.contains("7 of job_a"),
            "{greedy}"
        );
        std::thread::sleep(Duration::from_millis(10));
        let late = running.verdict(&limits, None).unwrap();
        assert!(
            late.contains("frame 7 of job_a") && late.contains("0.005 s"),
            "{late}"
        );
        running.end(0);
        assert_eq!(running.verdict(&limits, None), None);
    }
}
