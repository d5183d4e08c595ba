//! The operators of the network, forward and backward.

pub(crate) mod filter;
pub(crate) mod mix;
pub(crate) mod scale;
