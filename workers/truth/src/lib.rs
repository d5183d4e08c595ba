//! Monte Carlo reference: radiative transfer through water and surfaces, and the distance of the chain from it.
//!
//! Water has absorption a and scattering b in 1/m and one phase function; surfaces are Lambertian with a reflectance in
//! 0..=1 and an emitted radiance; lamps are small spheres; an optional flat sea surface has a sky and a sun.
//! Polarization, inelastic scattering and waves are not modeled. Channels are independent.
//!
//! [`TracedScene::trace`] traces light from the camera to its sources and requires only [`imaging::rays::Rays`] of the scene;
//! [`light_tracer`] traces it from a lamp and shares only the phase function with the former. Every random number has an
//! address ([`Address`]), so no result depends on the number of threads. [`Estimate`] contains means with their errors,
//! and [`Comparison`] the distance of a model.

mod compare;
mod converge;
mod daylight;
mod distance;
mod frame;
mod lamp;
pub mod light_tracer;
mod phase;
mod phase_model;
mod report;
mod scene;
mod sea;
mod surface;
mod walks;
mod water;

pub use compare::{BlockDifference, Comparison, MeasuredValue};
pub use converge::{ConvergedTruth, Goal, converge};
pub use dice::{Address, MOST_PATHS, MOST_PIXELS, stream};
pub use distance::Distance;
pub use estimate::{BATCHES, ErrorSpread, Estimate, Level, LightPart, PixelBlocks, PixelSums};
pub use frame::{NoTruth, PathBatch, Subject};
pub use lamp::SphereLamp;
pub use optics::Screen;
pub use phase::Phase;
pub use phase_model::PhaseModel;
pub use report::{ChainLight, PartComparisons, ReportRequest, TruthReport};
pub use scene::{Along, TracedScene};
pub use sea::{REFRACTIVE_INDEX, Sea, SeaSun, fresnel};
pub use surface::{Lambertian, PictureSurfaces, SurfaceMaterials};
pub use walk::{MOST_SEGMENTS, ORDERS, PathTally};
use walks::{dice, estimate, walk};
pub use water::{TurbidityField, WaterCoefficients, WaterLayers};
