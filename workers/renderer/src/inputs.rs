//! What a frame is rendered from before its plan: scene, camera, occluders, and patterns of its water. They are geometry; no light is
//! computed here.

pub(crate) mod camera;
pub(crate) mod caustics;
pub(crate) mod movement;
pub(crate) mod patches;
pub(crate) mod rays;
pub(crate) mod scene;
pub(crate) mod seen;
pub(crate) mod shutter;
