//! The truth: radiative transfer through water and surfaces by Monte Carlo, and how far the chain is from it.
//!
//! Water has absorption a and scattering b in 1/m and one phase function; surfaces are Lambertian with a reflectance within 0..=1 and
//! an emitted radiance; lamps are spheres of a small radius; above all may lie a flat sea surface with a sky and a sun. Polarization,
//! inelastic scattering and waves are left out. Channels are independent of each other.
//!
//! [`Scene::trace`] follows light from the camera to its sources and needs nothing of the scene but [`imaging::rays::Rays`];
//! [`lantern`] follows it from a lamp and shares nothing with the other but the phase function. Every random number has an
//! address ([`Address`]), so no result depends on the number of threads. [`Estimate`] says how well a mean is known, and
//! [`Comparison`] what that tells of a model.

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
