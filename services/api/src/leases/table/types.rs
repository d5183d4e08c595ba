//! The inputs and outputs of the lease table.

use std::collections::BTreeMap;
use std::ops::Range;

/// Milliseconds of a monotonic clock.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Millis(pub u64);

impl Millis {
    /// Adds milliseconds.
    #[must_use]
    pub fn plus(self, ms: u64) -> Self {
        Self(self.0.saturating_add(ms))
    }
}

/// Lease rules of all jobs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rules {
    /// Maximum time a worker may hold a frame: rendering plus upload.
    pub frame_limit_ms: u64,
    /// Whether frames of one job may come from different programs and machines.
    pub mixed: bool,
    /// Program and machine on which frames are checked; `None`: no frame is checked, and the first image of a job decides.
    pub reference: Option<Toolchain>,
}

impl Default for Rules {
    fn default() -> Self {
        Self {
            frame_limit_ms: u64::MAX,
            mixed: false,
            reference: None,
        }
    }
}

/// Provenance of a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Toolchain {
    /// Version of the software.
    pub code_version: String,
    /// CPU features that select code paths.
    pub cpu_features: String,
    /// Version of the ONNX Runtime used.
    pub onnx_runtime: Option<String>,
}

/// A job added to the table, new or after a restart.
#[derive(Debug, Clone, Default)]
pub struct JobEntry {
    /// The job's id.
    pub id: String,
    /// The caller that it is served for.
    pub caller: String,
    /// Number of frames.
    pub frames: u64,
    /// Expected cost of a frame.
    pub frame_cost: OpenCost,
    /// Higher goes first among the jobs of the caller.
    pub priority: i32,
    /// Frames with an image.
    pub done: Vec<Range<u64>>,
    /// Quarantined frames.
    pub failed: Vec<u64>,
    /// Strikes of frames that are still tried.
    pub strikes: BTreeMap<u64, u32>,
    /// Whether the job is paused.
    pub paused: bool,
    /// Provenance of its images; `None` before the first.
    pub made: Option<Toolchain>,
    /// Whether its frames may come from different programs and machines.
    pub mixed: bool,
}

/// Expected cost of unfinished frames.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct OpenCost {
    /// Microseconds of a slot.
    pub us: u64,
    /// Bytes of artifacts.
    pub bytes: u64,
}

impl OpenCost {
    /// The sum.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            us: self.us.saturating_add(other.us),
            bytes: self.bytes.saturating_add(other.bytes),
        }
    }

    /// The difference, at least 0.
    #[must_use]
    pub fn minus(self, other: Self) -> Self {
        Self {
            us: self.us.saturating_sub(other.us),
            bytes: self.bytes.saturating_sub(other.bytes),
        }
    }

    /// The cost of this many such frames.
    #[must_use]
    pub fn times(self, frames: u64) -> Self {
        Self {
            us: self.us.saturating_mul(frames),
            bytes: self.bytes.saturating_mul(frames),
        }
    }

    /// The mean of this many frames.
    #[must_use]
    pub fn divided(self, frames: u64) -> Self {
        let frames = frames.max(1);
        Self {
            us: self.us / frames,
            bytes: self.bytes / frames,
        }
    }
}

/// Frames leased to a worker.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Grant {
    /// The fencing token.
    pub token: u64,
    /// The job.
    pub job_id: String,
    /// Frames with the number of their attempt, from 1.
    pub frames: Vec<(u64, u32)>,
}

/// The token, frame or attempt is not that of a current lease.
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
    /// Description of the failure.
    pub error: String,
    /// Whether the frame is quarantined.
    pub quarantined: bool,
}

/// Sums over all jobs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Totals {
    /// Frames that are not leased.
    pub queued: u64,
    /// Frames under lease.
    pub leased: u64,
}

/// Duration of a lease without a heartbeat: three may be missed.
pub const TERM_MS: u32 = 15_000;
