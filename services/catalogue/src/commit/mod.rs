//! Writing: one task gathers changes into transactions.

pub(crate) mod deliveries;
pub(crate) mod insert;
pub(crate) mod progress;
pub(crate) mod writer;
