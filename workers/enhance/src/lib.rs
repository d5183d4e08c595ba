//! Image enhancement: methods that make an underwater picture easier to see, and the restorations that they are
//! compared with.
//!
//! [`hscm`] is the homomorphic filter, median, CLAHE, color merge and circular mask. The others are the methods of the
//! published comparison and two baselines; [`METHODS`] lists all of them. Every method takes any decoded raster of at least
//! one pixel and returns an 8-bit one; alpha is not computed with and is returned beside the result. A picture on which a
//! method is known to fail comes with a [`Warning`].
//!
//! A new method is one file in `methods` and one row of the table there. Nothing here knows the water: an enhancement must
//! not see the ground truth that it is judged by.

pub mod blocks;
mod elementary;
mod methods;
mod result;
mod signs;
mod variant;
mod warning;

pub use methods::{METHODS, Method, hscm, ibla, run, run_variant};
pub use result::{EnhanceError, Enhanced};
pub use variant::Variant;
pub use warning::Warning;
