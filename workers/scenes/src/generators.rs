//! The families of generated scenes.

pub(crate) mod families;
pub(crate) mod open_water;
pub(crate) mod pipeline;
pub(crate) mod shaft;
pub(crate) mod structure;
