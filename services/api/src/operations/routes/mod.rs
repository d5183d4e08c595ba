//! What operators and their machines ask.

pub(crate) mod backup;
pub(crate) mod livez;
pub(crate) mod metrics;
pub(crate) mod readyz;
pub(crate) mod version;
