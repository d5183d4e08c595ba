//! Running and maintaining a service.

pub(crate) mod backup;
pub(crate) mod cluster;
mod programs;
pub mod scrub;
pub mod serve;
pub(crate) mod worker;
