//! Running and maintaining a service.

pub(crate) mod backup;
pub(crate) mod scrub;
pub(crate) mod serve;
pub(crate) mod worker;
