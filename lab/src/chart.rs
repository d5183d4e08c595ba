//! Error against time: variants of a stage on scenes, each against its f64 reference.

mod bench;
mod experiment;
mod forward_scatter;
mod frame;
mod haze;
mod lamps;
mod methods;
mod scenes;
mod spatial;
mod style;
mod weighted;

pub use experiment::{PARAMETERS, run};
pub use scenes::{ChartScene, standard_scenes};
