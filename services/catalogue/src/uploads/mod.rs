//! Uploaded scenes, collections of them, and custom waters.

pub(crate) mod collections;
pub(crate) mod scenes;
pub(crate) mod waters;
