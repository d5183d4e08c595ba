//! Distribution of shards to workers by a broker, NATS JetStream.
//!
//! Completion state is only in the store. A lost message is published again, and the worker that gets a repeated one finds the
//! marker of its shard. Losing messages in the broker therefore costs only time.

mod broker;
mod delivery;
mod error;
mod fleet;
mod task;

pub(crate) use broker::Broker;
pub(crate) use delivery::{Delivery, Verdict};
pub(crate) use error::BrokerError;
pub(crate) use fleet::{Fleet, Member};
pub(crate) use task::Task;
