//! Random walks of photons.

pub(crate) mod dice;
pub(crate) mod estimate;
pub(crate) mod walk;
