//! Suspended matter: marine snow, turbidity patches, sediment clouds.

use serde::Deserialize;
use spec_derive::Described;

/// Marine snow.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Snow {
    /// particles per cubic meter; at most 400 000 in view
    #[field(within(0.0, 1e6), unit = "1/m³")]
    pub density_per_m3: f64,
    /// minimum particle radius
    #[field(within(1e-5, 0.02), default = 0.00015, unit = "m")]
    pub radius_m: f64,
    /// slope of Junge's power law of radii, from `radius_m` to ten times it
    #[field(within(1.5, 6.0), default = 4)]
    pub spectrum: f64,
    /// minimum depth of particles along the optical axis
    #[field(within(0.05, 100.0), default = 0.2, unit = "m")]
    pub near_m: f64,
    /// maximum depth of particles along the optical axis
    #[field(within(0.05, 100.0), default = 3, unit = "m")]
    pub far_m: f64,
    /// share of light scattered back by a particle
    #[field(within(0.0, 1.0), default = [0.5, 0.5, 0.5])]
    pub albedo: [f64; 3],
    /// share of particles that are irregular aggregates
    #[field(within(0.0, 1.0), default = 0)]
    pub aggregates: f64,
    /// current that moves the particles, in world axes, drawn as streaks during the exposure; none by default
    #[field(vector, within(-5.0, 5.0), unit = "m/s")]
    pub drift_m_per_s: Option<[f64; 3]>,
}

impl Snow {
    /// Snow of this density, with defaults for all other fields.
    #[must_use]
    pub const fn with_density(density_per_m3: f64) -> Self {
        Self {
            density_per_m3,
            radius_m: 0.000_15,
            spectrum: 4.0,
            near_m: 0.2,
            far_m: 3.0,
            albedo: [0.5; 3],
            aggregates: 0.0,
            drift_m_per_s: None,
        }
    }
}

/// A smooth field that multiplies the water's coefficients.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Turbidity {
    /// relative deficit of the clearest water below the mean
    #[field(within(0.0, 0.95))]
    pub contrast: f64,
    /// correlation length of the field
    #[field(within(0.05, 1000.0), default = 2, unit = "m")]
    pub scale_m: f64,
}

/// Clouds of stirred sediment with edges: banks above the bottom, and thruster plumes. They occlude and scatter light
/// in front of the water's own effects.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Sediment {
    /// extinction in the middle of a cloud
    #[field(within(0.0, 100.0), default = 3, unit = "1/m")]
    pub extinction_per_m: f64,
    /// share of the extinguished light scattered back
    #[field(within(0.0, 1.0), default = [0.4, 0.34, 0.25])]
    pub albedo: [f64; 3],
    /// share of the bottom under banks
    #[field(within(0.0, 1.0), default = 0.4)]
    pub cover: f64,
    /// height of the banks above the bottom
    #[field(within(0.01, 20.0), default = 0.5, unit = "m")]
    pub height_m: f64,
    /// size of the billows
    #[field(within(0.05, 20.0), default = 0.6, unit = "m")]
    pub scale_m: f64,
    /// edge width as a share of a billow
    #[field(within(0.05, 1.0), default = 0.25)]
    pub edge: f64,
    /// number of thrusters with plumes in view
    #[field(within(0, 8), default = 0)]
    pub thrusters: usize,
    /// camera height above the bottom for an uploaded image; 1.5 by default
    #[field(within(0.05, 1000.0), unit = "m", needs("scene.id", "scene.rgb"))]
    pub above_bottom_m: Option<f64>,
}
