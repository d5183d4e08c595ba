//! Changes of stored jobs and images.

pub(crate) mod control;
pub(crate) mod deletion;
pub(crate) mod import;
pub(crate) mod proofs;
pub(crate) mod upkeep;
pub(crate) mod versions;
