//! The setup of a tracer and its results.

use imaging::vector::DVec3;

use crate::estimate::Level;
use crate::water::WaterCoefficients;

/// Geometry of lamp, cameras and walls.
#[derive(Debug, Clone, PartialEq)]
pub struct Bench {
    /// The water.
    pub water: WaterCoefficients,
    /// Half angle of the lamp's cone, degrees; `None` for an isotropic lamp.
    pub cone_deg: Option<f64>,
    /// Depths of black walls, ascending, m; infinite for unbounded water.
    pub walls_m: Vec<f64>,
    /// Angles of the looks from z, positive away from the lamp, degrees.
    pub looks_deg: Vec<f64>,
    /// Distances of the cameras from the lamp: minimum and maximum of each bin, m.
    pub cameras_m: Vec<[f64; 2]>,
    /// Rings on the walls: angles at the lamp from its axis, ascending, degrees.
    pub rings_deg: Vec<f64>,
}

/// Radiance at cameras and irradiance of walls, for an intensity of 1 on the axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Shone {
    /// AirlightLevels by look, wall and camera.
    pub airlight: Vec<Vec<Vec<AirlightLevels>>>,
    /// Mean irradiance of scattered light by wall and ring.
    pub scattered: Vec<Vec<Level>>,
    /// Number of photons.
    pub photons: u64,
}

/// AirlightLevels at one camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AirlightLevels {
    /// Single scattering.
    pub single: Level,
    /// Single and multiple scattering.
    pub all: Level,
}

/// A photon, or a split-off part of one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Photon {
    pub(super) place: DVec3,
    pub(super) direction: DVec3,
    pub(super) weight: f64,
    pub(super) deepest: f64,
    pub(super) order: usize,
}
