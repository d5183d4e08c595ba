//! Shards handed to workers by a broker, NATS JetStream.
//!
//! The store is the truth and the broker never: a message that is lost is published again, and one that comes twice finds
//! the marker of its shard. So whatever the broker forgets costs time and nothing else.

mod broker;
mod delivery;
mod fleet;
mod task;

pub(crate) use broker::{Broker, BrokerError};
pub(crate) use delivery::{Delivery, Verdict};
pub(crate) use fleet::{Fleet, Member};
pub(crate) use task::Task;
