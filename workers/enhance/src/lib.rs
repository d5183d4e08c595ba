//! Image enhancement: methods that improve the visibility of underwater pictures, and restorations for comparison.
//!
//! [`hscm`] is the homomorphic filter, median, CLAHE and color merge. The others are the methods of the published comparison
//! and baselines; [`METHODS`] lists all of them, and the crate `spec` declares their parameters. Every method accepts any
//! decoded raster of at least one pixel and returns an 8-bit one; alpha is not processed and is returned with the result.
//! Pictures of a known failure have a [`Warning`]. [`enhance`] runs a chain of methods and applies a mask.
//!
//! A new method is one file in `methods` and one row of the table of `spec`. This crate does not depend on the water
//! model: an enhancement must not see the ground truth used to judge it. Networks of the user run outside of it, through a
//! [function of the caller](RunNetwork).

pub mod blocks;
mod chain;
mod elementary;
pub mod mask;
mod methods;
mod network;
mod result;
mod signs;
mod variant;
mod warning;

pub use chain::{Outcome, enhance};
pub use methods::{IBLA_GUIDED_DISTANCE, Method, hscm, ibla, run, run_variant};
pub use network::{RunNetwork, refuse_network};
pub use result::{EnhanceError, Enhanced};
pub use spec::METHODS;
pub use variant::Variant;
pub use warning::Warning;
