//! Style water models: ONNX networks that repaint a frame in the look of one water.
//!
//! A network takes an sRGB-encoded picture and returns one of the same size. That of the shipped waters and of those
//! trained here runs in this crate ([`net`]). Any other network runs on ONNX Runtime, a library that is loaded at
//! run time; without it everything else still works and [`RuntimeMissing`] tells how to install it.

mod card;
mod check;
mod error;
mod library;
pub mod net;
mod noise;
mod ports;
mod runtime;
mod search;
mod session;

pub use card::{Card, Parts, TableDistance, Training};
pub use check::{Unfit, check};
pub use error::StyleError;
pub use library::{Library, LibraryError, StyleModel, is_name};
pub use noise::noise;
pub use runtime::{Runtime, RuntimeMissing};
pub use session::{Beside, Session};

/// Scale of the range that a model is given, in meters: `1 − exp(−Z / scale)` for a range Z, 1 where there is none. At this
/// range a water of ordinary clearness leaves about a third of the contrast.
pub const RANGE_SCALE_M: f32 = 4.0;
