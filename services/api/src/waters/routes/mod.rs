//! Optical waters: the shipped ones, and those of the users' own.

pub(crate) mod create;
pub(crate) mod water;
