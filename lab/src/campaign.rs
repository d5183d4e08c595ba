//! Compares random and directed frames with the bounds of their plans: the exposed light of a frame is within the plan's bound of
//! the light of the f64 reference, and water costs little more than with the cheapest sufficient plan.
//!
//! Each frame is an ordinary job with a camera, a function of its family and seed. Edges of shadows, caustics and sediment have no
//! bound; frames affected by them are counted separately.

mod camera;
mod case;
mod climb;
mod directed;
mod experiment;
mod family;
mod knobs;
mod lamps;
mod measured;
mod outcome;
mod picture;
mod random;
mod summary;
#[cfg(test)]
mod tests;
mod water;

pub use experiment::{PARAMETERS, run};
