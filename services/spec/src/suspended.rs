//! What is suspended in the water: marine snow, patches of turbidity, and clouds of sediment.

use serde::Deserialize;
use spec_derive::Described;

/// Marine snow.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Snow {
    /// particles per cubic meter; at most 400 000 in view
    #[field(within(0.0, 1e6), unit = "1/m³")]
    pub density_per_m3: f64,
    /// least radius
    #[field(within(1e-5, 0.02), default = 0.00015, unit = "m")]
    pub radius_m: f64,
    /// slope of Junge's power law of radii, from `radius_m` to ten times it
    #[field(within(1.5, 6.0), default = 4)]
    pub spectrum: f64,
    /// depth of the nearest along the optical axis
    #[field(within(0.05, 100.0), default = 0.2, unit = "m")]
    pub near_m: f64,
    /// depth of the farthest
    #[field(within(0.05, 100.0), default = 3, unit = "m")]
    pub far_m: f64,
    /// share of the light that a particle sends back
    #[field(within(0.0, 1.0), default = [0.5, 0.5, 0.5])]
    pub albedo: [f64; 3],
    /// share of particles that are irregular aggregates of smaller ones
    #[field(within(0.0, 1.0), default = 0)]
    pub aggregates: f64,
    /// current that carries the particles, in the world's axes: drawn as streaks while the shutter is open; none by default
    #[field(vector, within(-5.0, 5.0), unit = "m/s")]
    pub drift_m_per_s: Option<[f64; 3]>,
}

impl Snow {
    /// Snow of this density, all else as in a description that says nothing of it.
    #[must_use]
    pub const fn of(density_per_m3: f64) -> Self {
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

/// Clouds of stirred sediment with edges: banks above the bottom, and plumes of thrusters. They hide and light up by
/// themselves, before the water does.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Sediment {
    /// extinction in the middle of a cloud
    #[field(within(0.0, 100.0), default = 3, unit = "1/m")]
    pub extinction_per_m: f64,
    /// share of the stopped light that a cloud sends back
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
    /// width of an edge as a share of a billow
    #[field(within(0.05, 1.0), default = 0.25)]
    pub edge: f64,
    /// thrusters whose plumes reach into the view
    #[field(within(0, 8), default = 0)]
    pub thrusters: usize,
    /// height of a picture's camera above the bottom; 1.5 by default
    #[field(within(0.05, 1000.0), unit = "m", needs("scene.id", "scene.rgb"))]
    pub above_bottom_m: Option<f64>,
}
