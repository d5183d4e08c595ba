//! Particles in the water.

pub mod sediment;
pub mod snow;
pub mod turbidity;
