//! Maps each pixel of the camera's picture to a pinhole picture in water.
//!
//! Output pixel (i, j) has distorted coordinates `((i-cx)/f, (j-cy)/f)`. The lens is inverted after Brown and Conrady
//! (Brown 1971), a flat port refracts the result, and the source picture is sampled there. Labels use the same map.

mod bound;
mod brown;
mod lens;
mod map;
mod sampling;

pub use bound::{place_bound_px, sampling_bound};
pub(crate) use lens::SEA_WATER;
pub(crate) use lens::sample_side;
pub use lens::{Fold, Lens, PortRefraction, pupil_error_px};
pub use map::{Coordinates, SourcePicture, coordinates, coordinates_reference};
pub use sampling::{Sampling, resample_reference};

/// A map that moves no pixel by more than this is omitted, px.
pub const STILL_PX: f64 = 0.01;
