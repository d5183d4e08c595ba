//! Checks of the parts of a description.

pub(crate) mod camera;
pub(crate) mod daylight;
pub(crate) mod enhance;
pub(crate) mod labels;
pub(crate) mod lights;
mod masks;
pub(crate) mod networks;
pub(crate) mod scene;
mod sequences;
pub(crate) mod truth;
pub(crate) mod water;
