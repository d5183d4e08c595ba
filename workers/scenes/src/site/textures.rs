//! Irregularities of surfaces.

pub(crate) mod dots;
pub(crate) mod lattice;
pub(crate) mod noise;
pub(crate) mod pits;
