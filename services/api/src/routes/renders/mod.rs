//! One frame, now.

pub(crate) mod create;
