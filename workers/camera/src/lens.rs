//! The lens: projection, blur and falloff.

pub mod defocus;
pub mod geometry;
pub mod vignette;
