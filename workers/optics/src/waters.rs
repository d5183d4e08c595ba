//! Waters and their optical properties.

pub mod medium;
pub mod preset;
pub mod water;
