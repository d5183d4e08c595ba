//! Forward scatter.

pub mod forward_scatter;
pub mod kernel;
pub mod layering;
