//! A rendered scene in air.

use imaging::geometry::Intrinsics;
use imaging::{Plane, Rgb};

/// A scene in air.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Linear radiance (white = 1, at least 0, may exceed 1), or reflectance where requested.
    pub radiance: Rgb<f32>,
    /// Range in meters along the line of sight. Non-finite values and values below a millimeter are holes.
    pub range: Option<Plane<f32>>,
    /// Instance of each pixel, 0 = background.
    pub instances: Option<Plane<u16>>,
    /// Camera intrinsics, if known.
    pub intrinsics: Option<Intrinsics>,
    /// Unit normals without relief in camera axes, supplied with the reflectance of procedural scenes.
    pub normals: Option<[Plane<f32>; 3]>,
}
