//! Stages of particles in the water.

pub(crate) mod sediment;
pub(crate) mod snow;
pub(crate) mod surroundings;
pub(crate) mod turbidity;
