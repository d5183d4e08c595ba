//! What is suspended in the water: marine snow and patches of turbidity, and how the optics ask for them.

use optics::snow::World;
use serde::Deserialize;

use crate::frame::Frame;

/// Marine snow.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Snow {
    /// Particles per cubic metre.
    pub density_per_m3: f64,
    /// Median radius in metres.
    pub radius_m: f64,
    /// Standard deviation of its logarithm.
    pub radius_spread: f64,
    /// Depth of the nearest particle in metres.
    pub near_m: f64,
    /// Depth of the farthest.
    pub far_m: f64,
    /// Share of the light that a particle sends back.
    pub albedo: [f64; 3],
}

/// A smooth field that multiplies the coefficients of the water.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Turbidity {
    /// How far the clearest water is below the mean, as a share of it.
    pub contrast: f64,
    /// Distance in metres at which two places have little in common.
    pub scale_m: f64,
}

/// The snow of a frame as the optics ask for it.
#[must_use]
pub fn snow(frame: &Frame) -> Option<optics::snow::Snow> {
    frame.water.snow.map(Snow::optics)
}

/// The turbidity of a frame as the optics ask for it.
#[must_use]
pub fn turbidity(frame: &Frame) -> Option<optics::turbidity::Turbidity> {
    let given = frame.water.turbidity?;
    Some(optics::turbidity::Turbidity {
        contrast: given.contrast,
        scale_m: given.scale_m,
    })
}

/// Where the particles and patches of a frame come from: all frames of a path share their water, any other has its own.
#[must_use]
pub fn water_world(frame: &Frame) -> World {
    World {
        seed: frame.seed,
        index: if frame.camera.path.is_some() {
            0
        } else {
            frame.index
        },
    }
}

impl Snow {
    pub(crate) fn optics(self) -> optics::snow::Snow {
        optics::snow::Snow {
            density_per_m3: self.density_per_m3,
            near_m: self.near_m,
            far_m: self.far_m,
            radius_m: self.radius_m,
            radius_spread: self.radius_spread,
            albedo: self.albedo,
        }
    }
}
