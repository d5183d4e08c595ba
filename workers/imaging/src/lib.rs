//! Planes, rasters, color transfer, transforms, codecs and the counter-based random stream.
//!
//! Pure functions without files, clock, environment or global state. [`cancel`] ends a computation early and never
//! changes a result.

mod border;
pub mod cancel;
pub mod codec;
pub mod digest;
pub mod geometry;
pub mod lab;
mod planes;
pub mod random;
pub mod rays;
pub mod simd;
pub mod transfer;
mod transforms;
pub mod vector;

pub use border::reflected;
pub use plane::{Plane, SizeError};
use planes::{plane, raster, rgb};
pub use raster::{Channels, Raster, Rgb8, Samples, luma1000};
pub use rgb::Rgb;
pub use transforms::{dct, fft};
