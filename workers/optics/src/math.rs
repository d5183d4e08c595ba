//! Elementary functions and error bounds.

pub(crate) mod elementary;
pub(crate) mod error_bound;
pub(crate) mod extremes;
pub mod legendre;
pub(crate) mod polynomial;
