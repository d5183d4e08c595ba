//! The folder of an export, its parts and its lists.

pub(crate) mod lists;
pub(crate) mod split;
pub(crate) mod target;
