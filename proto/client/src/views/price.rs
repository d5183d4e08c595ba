//! Prices of jobs.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Expected cost of a job: estimated from a few of its frames when it was submitted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Price {
    /// Time of one slot for all frames, s.
    pub slot_seconds: f64,
    /// Bytes of all artifacts.
    pub bytes: u64,
}

/// Estimated cost of a job.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Estimate {
    /// Duration on the current slots without other work, s.
    pub seconds: f64,
    /// Stored bytes.
    pub bytes: f64,
    /// Slots of the registered workers; at least 1.
    pub slots: u64,
    /// Time of one slot for all frames, s.
    pub slot_seconds: f64,
    /// Time of the most expensive of the sampled frames, s.
    pub frame_seconds: f64,
    /// Whether the service has rendered frames of every kind in the sample. Otherwise the times are typical figures, which may be
    /// several times too low.
    #[serde(default)]
    pub measured: bool,
}
