//! The stages of a frame, one file each. The order in which they run is that of [`crate::Slot::render`].

pub(crate) mod enhance;
pub(crate) mod files;
pub(crate) mod haze;
pub(crate) mod labels;
pub(crate) mod light;
pub(crate) mod measure;
pub(crate) mod range_file;
pub(crate) mod scene;
pub(crate) mod snow;
pub(crate) mod style;
pub(crate) mod water;
