//! What the service and `fathom-cluster jobs` tell each other, as JSON.

use serde::{Deserialize, Serialize};
use spec::SetState;

use crate::leases::Worker;

/// A job to begin a set for.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Order {
    /// Its id, unless the same submission has one already.
    pub id: String,
    /// Its canonical text.
    pub job: String,
    /// SHA-256 of the caller and the key under which a repeat finds the same job, whichever service it asks.
    pub key: Option<String>,
}

/// What became of an order.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Accepted {
    /// Its job.
    Job {
        /// The id.
        id: String,
        /// Where its set lies.
        location: String,
    },
    /// The key was used with another description.
    KeyConflict,
}

/// What `fathom-cluster jobs watch` sees, a line each.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Event {
    /// A set that is new or has changed; each comes again from time to time.
    Set(SeenSet),
    /// The workers of the broker.
    Workers(Vec<Worker>),
}

/// How far the set of a job is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SeenSet {
    /// The id of the job.
    pub id: String,
    /// Where the set lies.
    pub location: String,
    /// Whether it is worked on.
    pub state: SetState,
    /// Shards that are done.
    pub done: u64,
    /// When the last of them was, by the clock of the store; 0 without one.
    pub changed_ms: i64,
}
