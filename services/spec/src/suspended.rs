//! What is suspended in the water: marine snow, and patches of turbidity.

use serde::Deserialize;
use spec_derive::Described;

/// Marine snow.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Snow {
    /// particles per cubic meter; at most 400 000 in view
    #[field(within(0.0, 1e6), unit = "1/m³")]
    pub density_per_m3: f64,
    /// median radius
    #[field(within(1e-5, 0.02), default = 0.001, unit = "m")]
    pub radius_m: f64,
    /// standard deviation of its logarithm
    #[field(within(0.0, 1.0), default = 0.5)]
    pub radius_spread: f64,
    /// depth of the nearest along the optical axis
    #[field(within(0.05, 100.0), default = 0.2, unit = "m")]
    pub near_m: f64,
    /// depth of the farthest
    #[field(within(0.05, 100.0), default = 3, unit = "m")]
    pub far_m: f64,
    /// share of the light that a particle sends back
    #[field(within(0.0, 1.0), default = [0.5, 0.5, 0.5])]
    pub albedo: [f64; 3],
}

/// A smooth field that multiplies the coefficients of the water.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Turbidity {
    /// how far the clearest water is below the mean, as a share of it
    #[field(within(0.0, 0.95))]
    pub contrast: f64,
    /// distance at which two places have little in common
    #[field(within(0.05, 1000.0), default = 2, unit = "m")]
    pub scale_m: f64,
}
