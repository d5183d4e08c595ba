//! Speed against accuracy: runs variants, measures them, draws the charts and the maps.
//!
//! What is measured comes from the science crates; what is drawn is drawn twice from one description, as SVG and as a
//! picture. Clocks are read here, files are not: the command line writes what this crate answers.

pub mod campaign;
pub mod chain_stability;
pub mod chart;
pub mod plot;
pub mod speed;
pub mod stability;
pub mod table1;
pub mod waters;
