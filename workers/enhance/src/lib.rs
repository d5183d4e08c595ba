//! Image enhancement: methods that make an underwater picture easier to see without a model of the water.
//!
//! One method so far, [`hscm`]: homomorphic filter, median, CLAHE, colour merge and a circular mask.
//! Every method takes any decoded raster of at least one pixel and returns an 8-bit one; alpha is not computed
//! with and comes back beside the result. Nothing here knows the water: an enhancement must not see the ground
//! truth that it is judged by.

mod elementary;
pub mod hscm;
mod method;
mod reflect;

pub use method::{EnhanceError, Enhanced, METHODS, Method, Variant, run};
