//! Image enhancement: methods that make an underwater picture easier to see, and the restorations that they are
//! compared with.
//!
//! [`hscm`] is the homomorphic filter, median, CLAHE, color merge and circular mask. Beside it stand the methods of the
//! published comparison and two baselines; [`registry`] lists all of them with their sources. Every method takes any
//! decoded raster of at least one pixel and returns an 8-bit one; alpha is not computed with and comes back beside the
//! result. A picture on which a method is known to fail comes back with a [`Warning`].
//!
//! Nothing here knows the water: an enhancement must not see the ground truth that it is judged by.

pub mod baseline;
pub mod blocks;
mod elementary;
pub mod hscm;
pub mod ibla;
mod method;
pub mod rd;
mod reflect;
mod registry;
mod result;
pub mod rghs;
mod signs;
pub mod suir;
pub mod ulap;
mod warning;

pub use method::{Method, Variant, run, run_variant};
pub use registry::{GUIDED_PIXELS_MAX, METHODS, MethodInfo, registry};
pub use result::{EnhanceError, Enhanced};
pub use warning::Warning;
