//! The request for a water, and the errors found in it.

use crate::medium::Medium;
use crate::water::WaterError;

pub(super) const G_SHARE_OF_SCATTERING: f64 = 0.05;

/// The description of one water.
#[derive(Clone, Copy)]
pub(crate) struct Request<'a> {
    pub(crate) medium: &'a Medium,
    /// Whether lamps light the water, which needs scattering.
    pub(crate) lamps: bool,
}

/// Coefficients before the range scale.
pub(super) struct Coefficients {
    pub(super) absorption: Option<[f64; 3]>,
    pub(super) scattering: Option<[f64; 3]>,
    pub(super) attenuation: Option<[f64; 3]>,
    pub(super) focal_px: f64,
}

#[derive(Default)]
pub(super) struct Checks {
    pub(super) errors: Vec<WaterError>,
    pub(super) derived: Vec<&'static str>,
}
