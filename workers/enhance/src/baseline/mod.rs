//! Two simple methods that people know, to compare with.

pub mod clahe;
pub mod grey_world;
