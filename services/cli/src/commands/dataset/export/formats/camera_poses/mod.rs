//! Formats of camera poses.

pub(crate) mod colmap;
pub(crate) mod poses;
pub(crate) mod quaternion;
pub(crate) mod transforms;
pub(crate) mod view;
