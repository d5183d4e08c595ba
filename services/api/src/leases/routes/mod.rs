//! The worker protocol: protobuf messages as bodies of plain requests.

pub(crate) mod frame;
pub(crate) mod worker;
