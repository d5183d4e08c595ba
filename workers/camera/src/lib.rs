//! The camera: effects of port, lens, shutter and sensor on the arriving light.
//!
//! Pure functions from pictures in linear light to pictures and codes, in the order of the light: [`geometry`],
//! [`defocus`], [`vignette`], [`exposure`], [`sensor`], [`mosaic`], [`balance`], [`tone`], [`jpeg`]. Parts missing from
//! a description are the identity. Each fast variant has an f64 reference.

pub mod balance;
mod elementary;
pub mod exposure;
pub mod jpeg;
mod lens;
pub mod mosaic;
pub mod movement;
mod parts;
pub mod preset;
mod rounding;
pub mod rules;
pub mod sensor;
pub mod tone;

pub use lens::{defocus, geometry, vignette};
pub use parts::{Parts, PartsError, Scenery};
