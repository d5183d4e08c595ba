//! Single pictures.

pub(crate) mod enhance;
pub(crate) mod measure;
