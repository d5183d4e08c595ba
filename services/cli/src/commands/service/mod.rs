//! Running and maintaining a service.

pub(crate) mod backup;
pub(crate) mod cluster;
pub mod scrub;
pub mod serve;
pub(crate) mod worker;
