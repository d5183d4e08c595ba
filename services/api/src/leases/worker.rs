//! A worker as the API shows it.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A worker process.
#[derive(Debug, Clone, Serialize, Deserialize, ToSchema)]
pub struct Worker {
    /// `wrk_…`, new with every registration; for a worker of the broker, its name.
    pub id: String,
    /// Chosen name; those of the service's workers are `local-1`, `local-2`, …
    pub name: String,
    /// Frames rendered in parallel.
    pub slots: u32,
    /// Leased frames.
    pub leased_frames: u64,
    /// Milliseconds since its last message.
    pub silent_ms: u64,
    /// Version of the software.
    pub code_version: String,
    /// Version of its ONNX Runtime; null: none.
    pub onnx_runtime: Option<String>,
    /// CPU features that select its code paths.
    pub cpu_features: String,
}
