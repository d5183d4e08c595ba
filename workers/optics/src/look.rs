//! Changes of a finished picture.

pub(crate) mod blend;
pub(crate) mod haze;
