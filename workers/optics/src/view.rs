//! Rays, ranges and bounds of what a camera sees.

pub mod eye;
pub(crate) mod lattice;
pub mod lit_point;
pub mod range;
pub(crate) mod tiles;
pub(crate) mod visibility;
pub mod visible_bounds;
