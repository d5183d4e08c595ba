//! The inputs and outputs of the lease table.

use std::collections::BTreeMap;
use std::ops::Range;

/// Milliseconds of a clock that never goes back.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Millis(pub u64);

impl Millis {
    /// Later by so many milliseconds.
    #[must_use]
    pub fn plus(self, ms: u64) -> Self {
        Self(self.0.saturating_add(ms))
    }
}

/// What holds for all jobs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rules {
    /// How long a worker may hold a frame: longer than it may take to render and to hand in.
    pub frame_limit_ms: u64,
    /// Whether frames of one job may be made with different programs and machines.
    pub mixed: bool,
}

impl Default for Rules {
    fn default() -> Self {
        Self {
            frame_limit_ms: u64::MAX,
            mixed: false,
        }
    }
}

/// What a frame is made with.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Making {
    /// Version of the code.
    pub code_version: String,
    /// CPU features that choose its code paths.
    pub cpu_features: String,
    /// Version of the ONNX Runtime that was used.
    pub onnx_runtime: Option<String>,
}

/// A job as the table takes it up, fresh or after a restart.
#[derive(Debug, Clone, Default)]
pub struct JobEntry {
    /// The job's id.
    pub id: String,
    /// How many frames it has.
    pub frames: u64,
    /// Higher goes first.
    pub priority: i32,
    /// Frames that have their image.
    pub done: Vec<Range<u64>>,
    /// Frames that were given up.
    pub failed: Vec<u64>,
    /// Strikes of frames that are still tried.
    pub strikes: BTreeMap<u64, u32>,
    /// Whether to hold its frames back.
    pub paused: bool,
    /// What its images were made with; none before the first.
    pub made: Option<Making>,
}

/// Frames given to a worker.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Grant {
    /// The fencing token.
    pub token: u64,
    /// The job.
    pub job_id: String,
    /// Frames and the number of each one's attempt, from 1.
    pub frames: Vec<(u64, u32)>,
}

/// The token, frame or attempt of a call is not that of a current lease.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the lease is stale")]
pub struct Stale;

/// A failed or lost attempt that counts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StrikeEvent {
    /// The job.
    pub job: String,
    /// The frame.
    pub frame: u64,
    /// Strikes so far.
    pub strikes: u32,
    /// What happened.
    pub error: String,
    /// Whether the frame is given up.
    pub quarantined: bool,
}

/// Sums over all jobs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Totals {
    /// Frames that are not leased.
    pub queued: u64,
    /// Frames that are leased.
    pub leased: u64,
}
