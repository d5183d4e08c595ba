//! Planes, rasters, color transfer, transforms, codecs and the counter-based random stream.
//!
//! Pure functions without files, clock, environment or global state. [`cancel`] ends a computation early and never
//! changes a result.

mod border;
pub mod cancel;
pub mod codec;
pub mod dct;
pub mod digest;
pub mod fft;
pub mod geometry;
pub mod lab;
mod plane;
pub mod random;
mod raster;
pub mod rays;
mod rgb;
pub mod simd;
pub mod transfer;
pub mod vector;

pub use border::reflected;
pub use plane::{Plane, SizeError};
pub use raster::{Channels, Raster, Rgb8, Samples, luma1000};
pub use rgb::Rgb;
