//! Light and the particles in it.

pub(crate) mod daylight;
pub(crate) mod lamps;
pub(crate) mod sediment;
pub(crate) mod shadows;
pub(crate) mod suspended;
pub(crate) mod waters;
