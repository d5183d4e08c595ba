//! The network of the shipped and locally trained waters: 4735 parameters in one fixed graph.
//!
//! A context branch sees means of 4×4 pixels and expands at an eighth of the resolution; a thin branch at full
//! resolution adds it to its features; a learned affine color map does the rest. There are no global operations, so a
//! pixel depends only on its surroundings, in any crop.

mod fast;
pub mod layer;
pub mod onnx;
mod reference;
mod table;
pub(crate) mod wire;

pub use fast::{Network, Scratch};
pub use reference::apply_reference;
pub use table::{ColorTable, TableScratch};
