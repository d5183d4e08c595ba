//! Random distributions of values.

pub mod law;
pub(crate) mod node;
pub(crate) mod normal;
