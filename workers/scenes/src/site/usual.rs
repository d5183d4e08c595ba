//! The usual views of a site.

use imaging::vector::DVec3;

use crate::site::chance::Choices;

/// Parameters of drawn poses.
#[derive(Clone, Copy)]
pub(crate) struct Usual {
    pub(crate) dice: Choices,
    pub(crate) view: Viewpoint,
    pub(crate) roll: f64,
    /// Height of the bottom, m; in open water a level below the site.
    pub(crate) floor: f64,
    pub(crate) heights: Heights,
    /// Horizontal distances relative to that of `view`.
    pub(crate) stretch: [f32; 2],
    /// Largest rotation from the azimuth of `view`, degrees.
    pub(crate) turn_deg: f32,
    /// Minimum share of probes that hit a structure.
    pub(crate) least_structure: f64,
}

/// Range of heights above the floor, m.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Heights {
    Camera([f32; 2]),
    /// Heights of the target.
    Target([f32; 2]),
}

/// A camera whose line of sight passes above or below a point: `height_m` and `pitch_deg` determine by how much.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Viewpoint {
    /// Only x and y count.
    pub(crate) target: DVec3,
    /// Elevation of the line of sight.
    pub(crate) pitch_deg: f64,
    /// Azimuth of the line of sight, from y towards x.
    pub(crate) yaw_deg: f64,
    /// ViewCamera height above the world's z = 0.
    pub(crate) height_m: f64,
    /// Distance along the line of sight to the vertical through the target.
    pub(crate) distance_m: f64,
}
