//! The fleet, as people see it.

pub(crate) mod list;
