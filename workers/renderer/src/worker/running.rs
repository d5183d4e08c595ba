//! Running frames and their limits.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use wire::messages::Claim;

use crate::worker::held::Hold;

/// How long a frame may run after its lease is lost. Loops check their flag every few milliseconds; longer computations are inside a
/// library that does not.
pub(super) const AFTER_LOSS: Duration = Duration::from_secs(8);

/// Limits that end the worker when exceeded.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Maximum time of one frame.
    pub frame: Duration,
    /// How long a frame may run after its lease is lost.
    pub lost: Duration,
    /// Maximum resident memory of the whole worker, bytes.
    pub memory_bytes: u64,
}

impl Limits {
    /// No limit: for a worker that shares its process with its supervisor.
    pub const NONE: Self = Self {
        frame: Duration::MAX,
        lost: Duration::MAX,
        memory_bytes: u64::MAX,
    };

    /// Limits on a frame's time and a worker's memory.
    #[must_use]
    pub fn new(frame: Duration, memory_bytes: u64) -> Self {
        Self {
            frame,
            lost: AFTER_LOSS,
            memory_bytes,
        }
    }
}

/// The frames that are being rendered, by slot.
#[derive(Default)]
pub(crate) struct Running(pub(super) Mutex<BTreeMap<usize, Frame>>);

#[derive(Clone)]
pub(super) struct Frame {
    pub(super) claim: Claim,
    pub(super) begun: Instant,
    pub(super) hold: Hold,
    /// When the loss of its lease was noticed.
    pub(super) lost: Option<Instant>,
}

/// Why the process must end.
#[derive(Debug, PartialEq)]
pub(super) enum Verdict {
    /// A frame exceeded its time. Leases of other frames are released.
    Late { claim: Claim, message: String },
    /// The worker exceeded its memory.
    Guilty(String),
    /// A cancelled frame does not stop. Leases of other frames are released.
    Idle(String),
}

impl Running {
    pub(crate) fn begin(&self, slot: usize, claim: &Claim, hold: &Hold) {
        let frame = Frame {
            claim: claim.clone(),
            begun: Instant::now(),
            hold: hold.clone(),
            lost: None,
        };
        self.map().insert(slot, frame);
    }

    pub(crate) fn end(&self, slot: usize) {
        self.map().remove(&slot);
    }

    /// The reason to end the process, or `None`.
    pub(super) fn verdict(&self, limits: &Limits, memory_bytes: Option<u64>) -> Option<Verdict> {
        let mut running = self.map();
        for frame in running.values_mut().filter(|frame| frame.hold.is_lost()) {
            let lost = frame.lost.get_or_insert_with(Instant::now);
            if lost.elapsed() > limits.lost {
                let Claim { job_id, frame, .. } = &frame.claim;
                let message = format!("frame {frame} of {job_id} continues although its lease was lost");
                return Some(Verdict::Idle(message));
            }
        }
        if let Some(late) = running
            .values()
            .find(|frame| frame.begun.elapsed() > limits.frame)
        {
            let Claim { job_id, frame, .. } = &late.claim;
            let limit = limits.frame.as_secs_f64();
            let message = format!(
                "frame {frame} of {job_id} took more than {limit} s, its time limit (--frame-limit-s)"
            );
            let claim = late.claim.clone();
            return Some(Verdict::Late { claim, message });
        }
        let memory = memory_bytes.filter(|&bytes| bytes > limits.memory_bytes)?;
        let frames: Vec<String> = running
            .values()
            .map(|f| format!("{} of {}", f.claim.frame, f.claim.job_id))
            .collect();
        Some(Verdict::Guilty(format!(
            "the worker takes {} MiB and may take {} (--memory-limit-mib) while it renders frames: {}",
            memory >> 20,
            limits.memory_bytes >> 20,
            frames.join(", ")
        )))
    }

    pub(super) fn map(&self) -> MutexGuard<'_, BTreeMap<usize, Frame>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::worker::held::Held;

    fn claim() -> Claim {
        Claim {
            token: 1,
            job_id: "job_a".to_owned(),
            frame: 7,
            attempt: 1,
        }
    }

    #[test]
    fn what_is_within_its_limits_goes_on_and_what_is_not_is_named() {
        let running = Running::default();
        let hold = Held::default().take(1);
        let limits = Limits::new(Duration::from_millis(5), 100 << 20);
        assert_eq!(running.verdict(&limits, Some(100 << 20)), None);
        running.begin(0, &claim(), &hold);
        assert_eq!(running.verdict(&limits, None), None);
        let greedy = running.verdict(&limits, Some(101 << 20));
        assert!(
            matches!(&greedy, Some(Verdict::Guilty(text)) if text.contains("101 MiB") && text.contains("7 of job_a")),
            "{greedy:?}"
        );
        std::thread::sleep(Duration::from_millis(10));
        let Some(Verdict::Late { claim: late, message }) = running.verdict(&limits, None) else {
            panic!("the frame is late");
        };
        assert_eq!(late, claim());
        assert!(
            message.contains("frame 7 of job_a") && message.contains("0.005 s"),
            "{message}"
        );
        running.end(0);
        assert_eq!(running.verdict(&limits, None), None);
    }

    #[test]
    fn a_frame_that_nobody_waits_for_may_go_on_for_a_while() {
        let running = Running::default();
        let hold = Held::default().take(1);
        let limits = Limits {
            lost: Duration::from_millis(5),
            ..Limits::NONE
        };
        running.begin(0, &claim(), &hold);
        hold.lose();
        assert_eq!(running.verdict(&limits, None), None);
        std::thread::sleep(Duration::from_millis(10));
        let verdict = running.verdict(&limits, None);
        assert!(matches!(verdict, Some(Verdict::Idle(message)) if message.contains("frame 7 of job_a")));
    }
}
