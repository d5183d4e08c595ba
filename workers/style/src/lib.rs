//! Style water models: ONNX networks that repaint a frame in the look of one water.
//!
//! A network maps an sRGB-encoded picture to one of the same size. The network of the shipped waters and of those
//! trained here runs in this crate ([`net`]). All others run on ONNX Runtime, a library loaded at run time; without it
//! everything else still works, and [`RuntimeMissing`] explains how to install it.
//!
//! Networks of other [roles](ModelRole) enhance or measure the 8-bit picture of a frame: [`PictureNetwork`].

mod card;
mod check;
mod error;
mod library;
pub mod net;
mod noise;
mod picture;
mod ports;
mod role;
mod runtime;
mod search;
mod session;

pub use card::{LossTerms, MAX_SCALE, ModelCard, TableDistance, TrainingCard, is_scale};
pub use check::{Unfit, check};
pub use error::StyleError;
pub use library::{Library, LibraryError, StyleModel, is_name};
pub use noise::noise;
pub use picture::{NetworkError, PictureNetwork};
pub use role::{InputScale, Layout, ModelRole, PictureInput, SizeRule};
pub use runtime::{Runtime, RuntimeMissing};
pub use session::{ModelInputs, Repainted, Session};

/// Scale of a model's range input, in meters: `1 − exp(−Z / scale)` for a range Z, 1 for holes. At this range a water
/// of ordinary clarity leaves about a third of the contrast.
pub const RANGE_SCALE_M: f32 = 4.0;
