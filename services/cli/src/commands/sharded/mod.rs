//! Commands over sharded datasets, in a folder or a bucket.

pub(crate) mod buckets;
pub(crate) mod dispatch;
pub(crate) mod engine;
pub(crate) mod failure;
pub(crate) mod gc;
pub(crate) mod import;
pub(crate) mod open;
pub(crate) mod reading;
pub(crate) mod render;
pub(crate) mod seal;
pub(crate) mod status;
mod tally;
pub(crate) mod verify;
pub(crate) mod worker;
