//! Daylight settings.

use serde::{Deserialize, Serialize};
use spec_derive::Described;

/// Daylight of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
#[serde(untagged)]
pub enum Daylight {
    /// A named daylight.
    Named(NamedDaylight),
    /// A described sky.
    Sky(Sky),
}

/// Daylight without parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum NamedDaylight {
    /// Night if a veiling light is given, or if point or spot lamps shine and no depth is given; else the default
    /// sky.
    Auto,
    /// Night.
    None,
}

impl Default for Daylight {
    fn default() -> Self {
        Self::Named(NamedDaylight::Auto)
    }
}

/// Sky and sea state.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Sky {
    /// elevation of the sun in air
    #[field(within(5.0, 90.0), unit = "degree", default = 45)]
    pub sun_elevation_deg: f64,
    /// azimuth of the sun: in a world from the x axis towards the y axis; for an uploaded image from the camera's
    /// right towards its line of sight
    #[field(within(-360.0, 360.0), unit = "degree", default = 0)]
    pub sun_azimuth_deg: f64,
    /// share of the sky covered by clouds; 1 hides the sun
    #[field(within(0.0, 1.0), default = 0.5)]
    pub cloud_cover: f64,
    /// wind speed, which sets the roughness of the surface
    #[field(within(0.0, 20.0), unit = "m/s", default = 4)]
    pub wind_m_per_s: f64,
}

impl Default for Sky {
    fn default() -> Self {
        Self {
            sun_elevation_deg: 45.0,
            sun_azimuth_deg: 0.0,
            cloud_cover: 0.5,
            wind_m_per_s: 4.0,
        }
    }
}
