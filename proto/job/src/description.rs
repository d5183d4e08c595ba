//! The types of a frame description.

pub(crate) mod artifact;
pub(crate) mod camera;
pub(crate) mod classes;
pub(crate) mod daylight;
pub(crate) mod enhancement;
pub(crate) mod frame;
pub(crate) mod inhabited;
pub(crate) mod label_types;
pub(crate) mod light;
pub(crate) mod results;
pub(crate) mod scene;
pub(crate) mod scene_files;
pub(crate) mod scene_parts;
pub(crate) mod suspended;
pub mod truth;
pub(crate) mod water;
