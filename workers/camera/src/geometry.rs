//! Where each pixel of the camera's picture looks into a picture that a pinhole would take in the water.
//!
//! Output pixel (i, j) has distorted coordinates `((i-cx)/f, (j-cy)/f)`. The lens is inverted after Brown and Conrady (Brown
//! 1971), a flat port refracts what remains, and the source picture is sampled there. Labels follow the same map.

mod bound;
mod lens;
mod map;
mod sampling;

pub use bound::{place_bound_px, sampling_bound};
pub(crate) use lens::SEA_WATER;
pub use lens::{Fold, Lens, Refraction, pupil_error_px};
pub use map::{Coordinates, Source, coordinates, coordinates_reference};
pub use sampling::{Sampling, resample_reference};

/// Longest way that a map may move a pixel and still be left out, in pixels.
pub const STILL_PX: f64 = 0.01;
