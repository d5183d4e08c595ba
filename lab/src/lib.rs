//! The laboratory: speed against accuracy, stability, and what the waters look like. It makes the pages of `docs/`; the
//! product does not know it.
//!
//! What is measured comes from the science crates; what is drawn is drawn twice from one description, as SVG and as a
//! picture. Clocks are read here, files are not: the commands of `fathom-lab` write what this library returns.

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
