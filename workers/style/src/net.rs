//! The network of the shipped waters, and of those that are trained here: 4735 numbers in one fixed graph.
//!
//! A context branch sees means of 4×4 pixels and widens at an eighth of the resolution; a thin branch at full
//! resolution takes it in; a learned affine color map does the rest. Nothing depends on the whole frame, so the same
//! surroundings give the same pixel whatever the crop.

mod fast;
pub mod layer;
pub mod onnx;
mod reference;
mod table;
pub(crate) mod wire;

pub use fast::{Network, Scratch};
pub use reference::apply_reference;
pub use table::{Table, TableScratch};
