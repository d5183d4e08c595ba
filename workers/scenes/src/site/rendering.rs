//! The picture of a site.

pub(crate) mod camera;
pub(crate) mod geometry;
pub(crate) mod light;
pub(crate) mod outline;
pub(crate) mod picture;
pub(crate) mod rows;
pub(crate) mod shade;
