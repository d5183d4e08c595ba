//! The stages of a frame, one file each with `assess`, which plans it from cheap bounds, and `run`, which executes the plan.
//! [`crate::pipeline`] defines their order.

pub(crate) mod airlight;
pub(crate) mod camera;
pub(crate) mod daylight;
pub(crate) mod enhance;
pub(crate) mod files;
pub(crate) mod haze;
pub(crate) mod labels;
pub(crate) mod lamps;
pub(crate) mod measure;
pub(crate) mod model_error;
pub(crate) mod networks;
mod particles;
mod range_file;
pub(crate) mod style;
pub(crate) mod truth;
pub(crate) mod water;

use particles::surroundings;
pub(crate) use particles::{sediment, snow, turbidity};
