//! Monte Carlo reference: radiative transfer through water and surfaces, and the distance of the chain from it.
//!
//! Water has absorption a and scattering b in 1/m and one phase function; surfaces are Lambertian with a reflectance in
//! 0..=1 and an emitted radiance; lamps are small spheres; an optional flat sea surface has a sky and a sun.
//! Polarization, inelastic scattering and waves are not modeled. Channels are independent.
//!
//! [`Scene::trace`] traces light from the camera to its sources and requires only [`imaging::rays::Rays`] of the scene;
//! [`lantern`] traces it from a lamp and shares only the phase function with the former. Every random number has an
//! address ([`Address`]), so no result depends on the number of threads. [`Estimate`] contains means with their errors,
//! and [`Comparison`] the distance of a model.

mod compare;
mod converge;
mod daylight;
mod dice;
mod estimate;
mod frame;
mod lamp;
pub mod lantern;
mod law;
mod phase;
mod report;
mod scene;
mod sea;
mod surface;
mod walk;
mod water;

pub use compare::{Comparison, Difference, Measured};
pub use converge::{Goal, Truth, converge};
pub use dice::{Address, MOST_PATHS, MOST_PIXELS, stream};
pub use estimate::{BATCHES, Blocks, Estimate, Level, Part, Pixel, Spread};
pub use frame::{NoTruth, Shutter, Subject};
pub use lamp::Lamp;
pub use law::Law;
pub use optics::Screen;
pub use phase::Phase;
pub use report::{Asked, ChainLight, Parts, Report};
pub use scene::{Along, Scene};
pub use sea::{REFRACTIVE_INDEX, Sea, Sun, fresnel};
pub use surface::{Material, Picture, Surfaces};
pub use walk::{MOST_SEGMENTS, ORDERS, Tally};
pub use water::{Coefficients, Layers, Murk};
