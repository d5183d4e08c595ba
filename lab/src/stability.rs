//! Failure regions of enhancements and metrics: pictures degraded step by step, the results of each method, and the sensitivity of
//! the result to small changes.

mod cell;
mod degradation;
mod experiment;
mod maps;

pub use experiment::{PARAMETERS, run};
