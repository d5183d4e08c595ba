//! Leases on frames: grant, beat, fence, expire, strike; and the worker's client over HTTP.
//!
//! [`LeaseTable`] is a pure state machine: time and tokens are arguments, so a test can play any history. Delivery is at
//! least once; a stale token changes nothing.

mod claims;
pub mod client;
mod job;
mod lease;
mod suspects;
mod table;
mod types;

pub use table::LeaseTable;
pub use types::{Beat, Grant, JobEntry, Millis, Stale, StrikeEvent, Totals, WorkerRow};
