//! The laboratory: speed against accuracy, stability, and the look of the waters. It generates the pages of `docs/`; the product
//! does not depend on it.
//!
//! The science crates compute the measured values. Each figure is drawn from one description, as SVG and as a picture. This library
//! reads clocks but no files; the commands of `fathom-lab` write its results.

pub mod campaign;
pub mod chain_stability;
pub mod chart;
pub mod frame_truth;
pub mod ibla;
mod johnson;
pub mod lamp_truth;
pub mod plot;
pub mod speed;
pub mod stability;
pub mod table1;
pub mod waters;

pub use johnson::johnson;
