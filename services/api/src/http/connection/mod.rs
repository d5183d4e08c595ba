//! Connections and the bytes that they receive.

pub(crate) mod held;
pub(crate) mod hosts;
pub(crate) mod listener;
pub(crate) mod patient;
pub(crate) mod receive;
pub(crate) mod spool;
