//! What is suspended in the water: marine snow, and patches of turbidity.

use serde::Deserialize;

/// Marine snow.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Snow {
    /// particles per cubic metre; at most 400 000 in view
    pub density_per_m3: f64,
    /// median radius
    pub radius_m: f64,
    /// standard deviation of its logarithm
    pub radius_spread: f64,
    /// depth of the nearest along the optical axis
    pub near_m: f64,
    /// depth of the farthest
    pub far_m: f64,
    /// share of the light that a particle sends back
    pub albedo: [f64; 3],
}

/// A smooth field that multiplies the coefficients of the water.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Turbidity {
    /// how far the clearest water is below the mean, as a share of it
    pub contrast: f64,
    /// distance at which two places have little in common
    pub scale_m: f64,
}
