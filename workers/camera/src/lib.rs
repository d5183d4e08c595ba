//! The camera behind the water: what port, lens, shutter and sensor make of the light that reaches them.
//!
//! Pure: pictures in linear light in, pictures and codes out. The order is that of the light: [`geometry`], [`defocus`],
//! [`vignette`], [`exposure`], [`sensor`], [`mosaic`], [`balance`], [`tone`], [`jpeg`]. Every part that a description leaves
//! out is the identity. Each fast form has a reference in f64 beside it.

pub mod balance;
pub mod defocus;
mod elementary;
pub mod exposure;
pub mod geometry;
pub mod jpeg;
pub mod mosaic;
pub mod movement;
mod parts;
pub mod preset;
mod rounding;
pub mod rules;
pub mod sensor;
pub mod tone;
pub mod vignette;

pub use parts::{Parts, PartsError, Scenery};
