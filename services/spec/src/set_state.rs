//! Whether a set is to be worked on.

use serde::{Deserialize, Serialize};

/// Whether a set is to be worked on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SetState {
    /// Shards are rendered.
    Running,
    /// Shards that were begun are finished, and no others are begun.
    Paused,
    /// Nothing is rendered any more.
    Cancelled,
}
