//! Pictures in memory.

pub(crate) mod plane;
pub(crate) mod raster;
pub(crate) mod rgb;
