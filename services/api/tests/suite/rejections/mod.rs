//! Rejected input and misbehaving workers.

pub(crate) mod bad_input;
pub(crate) mod bad_uploads;
pub(crate) mod error_page;
pub(crate) mod hostile;
pub(crate) mod messages;
pub(crate) mod misbehavior;
