//! Light from above: the veil by direction, and what daylight does to surfaces.

use serde::Deserialize;
use spec_derive::Described;

/// Light from above.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize, Described)]
#[serde(deny_unknown_fields, default)]
pub struct FromAbove {
    /// how the veil depends on the direction of sight; absent: `constant`
    pub veil: Option<VeilForm>,
    /// what is as bright as white; absent: as `ambient` has it, else `exposed`
    pub level: Option<DaylightLevel>,
    /// radiance of the horizon over the downwelling irradiance; absent: derived from a, b and b_b/b
    #[field(within(1e-5, 1.0))]
    pub horizon: Option<[f64; 3]>,
    /// slope of the logarithm of radiance with the cosine from the vertical; absent: derived
    #[field(within(0.0, 10.0))]
    pub p: Option<[f64; 3]>,
    /// its curvature; absent: derived
    #[field(within(-5.0, 5.0))]
    pub q: Option<[f64; 3]>,
    /// what daylight does to surfaces; absent: `none`
    pub surfaces: Option<SurfaceLight>,
    /// share of the sun in the irradiance just below the surface; absent: 0, an overcast sky
    #[field(within(0.0, 1.0))]
    pub sun_share: Option<f64>,
    /// where the sun stands and whether it casts shadows; absent: its defaults
    pub sun: Option<Sun>,
    /// rays that tell how much of the light from all around reaches a surface; absent: 0, all of it
    #[field(within(0, 64))]
    pub ambient_rays: Option<usize>,
    /// the pattern that waves draw with sunlight; absent: even sunlight
    pub caustics: Option<Caustics>,
    /// whether the pattern shows in the water before surfaces as well; absent: false
    pub shafts: Option<bool>,
}

impl FromAbove {
    /// What daylight does to surfaces.
    #[must_use]
    pub fn surfaces(&self) -> SurfaceLight {
        self.surfaces.unwrap_or(SurfaceLight::None)
    }
}

/// What daylight does to surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum SurfaceLight {
    /// The same light on all, as `ambient` has it.
    None,
    /// Less light the deeper a surface lies.
    Depth,
    /// The same, with the slope of the surface, the sun, shadows and caustics.
    Normal,
}

/// Where the sun stands.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
pub struct Sun {
    /// height above the horizon in air
    #[field(within(5.0, 90.0), unit = "deg", default = 60)]
    pub elevation_deg: f64,
    /// where it stands around the vertical: from the world's x axis towards its y axis, or in a picture without a place from the
    /// right of the camera to the side that it looks to
    #[field(within(-360.0, 360.0), unit = "deg", default = 0)]
    pub azimuth_deg: f64,
    /// whether surfaces cast shadows
    #[field(default = "hard")]
    pub shadow: SunShadow,
}

impl Default for Sun {
    fn default() -> Self {
        Self {
            elevation_deg: 60.0,
            azimuth_deg: 0.0,
            shadow: SunShadow::Hard,
        }
    }
}

/// Whether surfaces cast shadows in the light of the sun.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum SunShadow {
    /// They do not.
    None,
    /// Shadows with sharp edges.
    Hard,
}

/// The waves that draw caustics.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
pub struct Caustics {
    /// side of the square after which the pattern repeats
    #[field(within(0.5, 20.0), unit = "m", default = 3)]
    pub tile_m: f64,
    /// cells along that side, a power of two
    #[field(within(32, 512), default = 128)]
    pub cells: usize,
    /// root mean square of the slope of the waves
    #[field(within(0.0, 0.3), default = 0.12)]
    pub slope: f64,
    /// where the wind blows to, as the azimuth of the sun
    #[field(within(-360.0, 360.0), unit = "deg", default = 0)]
    pub wind_deg: f64,
    /// frames a second, by which the waves run; absent: they stand still
    #[field(within(0.1, 1000.0))]
    pub fps: Option<f64>,
}

/// How the veil depends on the direction of sight.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum VeilForm {
    /// The same in all directions.
    Constant,
    /// The veiling light stands at the horizon; above it is brighter, below darker.
    Field,
    /// The same, with the brightness at the horizon that daylight gives beside white surfaces.
    Physical,
}

/// What is as bright as white in daylight.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum DaylightLevel {
    /// A white horizontal patch at the camera's depth, in its brightest channel.
    Exposed,
    /// A white horizontal patch just below the surface of the sea.
    Absolute,
}
