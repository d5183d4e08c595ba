//! The light of lamps in six waters, on walls and in the water: Monte Carlo against the chain.

mod cell;
mod experiment;
mod model;
mod tables;

pub use experiment::{PARAMETERS, run};
