//! Optical water presets.

pub(crate) mod list;
