//! What operators and their machines ask.

pub(crate) mod backup;
pub(crate) mod probes;
