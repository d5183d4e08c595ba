//! The daylight of a frame.

use super::field::Field;
use super::gaze::Gaze;
use super::model::{Caustics, SurfaceLight};
use super::sun::SunLight;
use super::wide::WideScattering;

/// Daylight in one water, for one camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Daylight {
    pub(crate) surfaces: SurfaceLight,
    pub(crate) sun: Option<SunLight>,
    /// Rays of ambient occlusion for each surface.
    pub(crate) rays: usize,
    /// The waves, and the blur of their pattern by the water.
    pub(crate) caustics: Option<(Caustics, Blur)>,
    /// Whether the pattern of the waves shows on surfaces.
    pub(crate) draws_caustics: bool,
    pub(crate) has_shafts: bool,
    /// Whether surfaces occlude the daylight that causes the veil.
    pub(crate) occludes_veil: bool,
    /// True meters of one length of the range.
    pub(crate) scale: f64,
    /// The radiance of each channel.
    pub(crate) fields: [Field; 3],
    /// How the water scatters outside of the forward peak.
    pub(crate) wide: WideScattering,
    /// Depth of the camera in lengths of the range.
    pub(crate) depth: f64,
    /// How far the bottom is below the camera, in the same; infinite without one.
    pub(crate) below: f64,
    /// The irradiance at the camera over that which is white.
    pub(crate) level: [f64; 3],
    pub(crate) gaze: Gaze,
}

/// How the water blurs the pattern: of the channel with the median c, per meter of true length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blur {
    /// c.
    pub attenuation: f64,
    /// G.
    pub spread_attenuation: f64,
    /// Angles of the two kernels in radians at the range 0, and how they grow with it.
    pub angles: [[f64; 2]; 2],
    /// Share of the wider one at the range 0, and how it grows with it.
    pub wide: [f64; 2],
}
