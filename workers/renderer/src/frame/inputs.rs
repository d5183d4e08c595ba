//! Inputs of a frame that precede its plan: scene, camera, occluders and patterns of the water. They are geometry; this module
//! computes no light.

pub(crate) mod camera;
pub(crate) mod caustics;
pub(crate) mod movement;
pub(crate) mod patches;
pub(crate) mod rays;
pub(crate) mod scene;
pub(crate) mod seen;
pub(crate) mod shutter;
