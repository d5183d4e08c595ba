//! JSON messages between the service and `fathom child jobs`.

use serde::{Deserialize, Serialize};
use spec::SetState;

use crate::leases::Worker;

/// An order to create the set of a job.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Order {
    /// Id of the job, unless an earlier submission with this key has one.
    pub id: String,
    /// Canonical text of the job.
    pub job: String,
    /// SHA-256 of caller and idempotency key, so that a repeat finds the same job through every service.
    pub key: Option<String>,
}

/// Result of an order.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Accepted {
    /// The job of the order.
    Job {
        /// The id.
        id: String,
        /// Location of the set.
        location: String,
    },
    /// The key was used with another description.
    KeyConflict,
}

/// A line of `fathom child jobs watch`.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Event {
    /// A new or changed set. Unchanged sets repeat from time to time.
    Set(SeenSet),
    /// The workers of the broker.
    Workers(Vec<Worker>),
}

/// Progress of a job's set.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SeenSet {
    /// Id of the job.
    pub id: String,
    /// Location of the set.
    pub location: String,
    /// State of the set.
    pub state: SetState,
    /// Completed shards.
    pub done: u64,
    /// Time of the latest completed shard by the store's clock; 0 without one.
    pub changed_ms: i64,
}
