//! Images and their artifacts.

pub(crate) mod artifacts;
pub(crate) mod stored;
