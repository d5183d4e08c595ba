//! Error against time: variants of a stage on scenes, each against its f64 reference.

mod bench;
mod experiment;
mod forward_scatter;
mod frame;
mod ibla;
mod lamps;
mod scenes;
mod style;

pub use experiment::{PARAMETERS, run};
