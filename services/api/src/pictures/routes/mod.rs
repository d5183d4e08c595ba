//! A user's own pictures.

pub(crate) mod enhance;
pub(crate) mod measure;
