//! Image enhancement: methods that improve the visibility of underwater pictures, and restorations for comparison.
//!
//! [`hscm`] is the homomorphic filter, median, CLAHE, color merge and circular mask. The others are the methods of the
//! published comparison and two baselines; [`METHODS`] lists all of them. Every method accepts any decoded raster of at
//! least one pixel and returns an 8-bit one; alpha is not processed and is returned with the result. Pictures on which
//! a method is known to fail carry a [`Warning`].
//!
//! A new method is one file in `methods` and one row of the table there. This crate does not depend on the water model:
//! an enhancement must not see the ground truth used to judge it.

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
