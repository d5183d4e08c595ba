use serde::{Deserialize, Serialize};

/// State of a set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SetState {
    /// Shards are rendered.
    Running,
    /// Started shards are finished; others do not start.
    Paused,
    /// No more shards are rendered.
    Cancelled,
}
