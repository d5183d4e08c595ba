//! How the daylight of a frame is computed.

use serde::Deserialize;
use spec::{Beyond, Sky};

/// Diffuse light of a clear sky over the direct light of a sun in the zenith; it grows as `1/sin(elevation)` (Bird and Hulstrom 1981,
/// clear marine air).
const CLEAR_DIFFUSE: f64 = 0.14;
/// Fresnel transmittance of an even sky through a calm surface.
const SKY_TRANSMITTANCE: f64 = 0.934;
/// Mean square slope of the sea without wind, and its growth with each m/s (Cox and Munk 1954, clean surface).
const CALM_SLOPE_SQUARE: f64 = 0.003;
const SLOPE_SQUARE_PER_WIND: f64 = 0.005_12;
/// Caustics are traced for slopes up to this: steeper waves break.
const STEEPEST: f64 = 0.3;
/// Rays of ambient occlusion from each surface.
const AMBIENT_RAYS: usize = 8;

/// Models of daylight, and the numbers that they take.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DaylightModel {
    /// How daylight lights surfaces.
    pub surfaces: SurfaceLight,
    /// Share of the sun in the irradiance just below the surface, 0..=1.
    pub sun_share: f64,
    /// The position of the sun.
    pub sun: Sun,
    /// Rays of ambient occlusion from each surface; 0 disables it.
    pub ambient_rays: usize,
    /// The waves that cause caustics; `None`: even sunlight.
    pub caustics: Option<Caustics>,
    /// Whether caustics show in the water before surfaces as well.
    pub shafts: bool,
    /// Whether surfaces occlude the daylight that causes the veil.
    pub occludes_veil: bool,
}

impl Default for DaylightModel {
    fn default() -> Self {
        Self {
            surfaces: SurfaceLight::None,
            sun_share: 0.0,
            sun: Sun::default(),
            ambient_rays: 0,
            caustics: None,
            shafts: false,
            occludes_veil: false,
        }
    }
}

impl DaylightModel {
    /// All effects of a sky on a scene of reflectance, or on a picture that contains its illumination. `frames_per_s` is the rate
    /// at which waves move from frame to frame; `None`: they do not move.
    #[must_use]
    pub fn from_sky(sky: &Sky, is_reflectance: bool, frames_per_s: Option<f64>) -> Self {
        let sun_share = sun_share(sky);
        let has_sun = sun_share > 0.0;
        let slope = (CALM_SLOPE_SQUARE + SLOPE_SQUARE_PER_WIND * sky.wind_m_per_s).sqrt();
        let caustics = Caustics {
            slope: slope.min(STEEPEST),
            fps: frames_per_s,
            ..Caustics::default()
        };
        Self {
            surfaces: if is_reflectance {
                SurfaceLight::Normal
            } else {
                SurfaceLight::None
            },
            sun_share,
            sun: Sun {
                elevation_deg: sky.sun_elevation_deg,
                azimuth_deg: sky.sun_azimuth_deg,
                casts_shadows: true,
            },
            ambient_rays: if is_reflectance { AMBIENT_RAYS } else { 0 },
            caustics: has_sun.then_some(caustics),
            shafts: has_sun,
            occludes_veil: true,
        }
    }

    /// Numbers beyond their limits.
    pub(crate) fn beyond(&self) -> Vec<Beyond> {
        let mut all = Vec::new();
        let mut check = |field: &'static str, value: f64, low: f64, high: f64| {
            if !(low..=high).contains(&value) {
                all.push(Beyond {
                    field,
                    part: None,
                    value,
                    limit: format!("{low}..={high}"),
                });
            }
        };
        check("sun_share", self.sun_share, 0.0, 1.0);
        check("sun_elevation_deg", self.sun.elevation_deg, 5.0, 90.0);
        check("sun_azimuth_deg", self.sun.azimuth_deg, -360.0, 360.0);
        if let Some(waves) = self.caustics {
            check("slope", waves.slope, 0.0, STEEPEST);
            check("tile_m", waves.tile_m, 0.5, 20.0);
        }
        all
    }
}

/// The sun's share in the irradiance just below the surface. In air it is `(1 − n²)/(1 + 0.14/sin h)` at the elevation h under the cloud
/// cover n (Kasten and Czeplak 1980); the surface then transmits sun and sky differently.
fn sun_share(sky: &Sky) -> f64 {
    let (sine, cosine) = sky.sun_elevation_deg.to_radians().sin_cos();
    let in_water = (1.0 - (cosine / REFRACTIVE_INDEX).powi(2)).sqrt();
    let in_air = (1.0 - sky.cloud_cover * sky.cloud_cover) / (1.0 + CLEAR_DIFFUSE / sine);
    let direct = in_air * (1.0 - fresnel(in_water));
    let diffuse = (1.0 - in_air) * SKY_TRANSMITTANCE;
    direct / (direct + diffuse)
}

/// A level bottom, which sends daylight back up.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Bottom {
    /// How far below the camera, m.
    pub below_m: f64,
    /// Its reflectance, 0..=1.
    pub reflectance: [f64; 3],
}

/// How daylight lights surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SurfaceLight {
    /// By one factor for the whole scene.
    None,
    /// By depth and slope, with the sun, shadows and caustics.
    Normal,
}

/// The position of the sun.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Sun {
    /// Elevation above the horizon in air, degrees, 5..=90.
    pub elevation_deg: f64,
    /// Azimuth, degrees.
    pub azimuth_deg: f64,
    /// Whether surfaces cast shadows in its light.
    pub casts_shadows: bool,
}

impl Default for Sun {
    fn default() -> Self {
        Self {
            elevation_deg: 60.0,
            azimuth_deg: 0.0,
            casts_shadows: true,
        }
    }
}

/// The waves that draw caustics.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Caustics {
    /// Side of the square after which the pattern repeats, m.
    pub tile_m: f64,
    /// Cells along that side, a power of two from 32 to 512.
    pub cells: usize,
    /// Root mean square of the slope of the waves.
    pub slope: f64,
    /// Direction of the wind, degrees, as the azimuth of the sun.
    pub wind_deg: f64,
    /// Frames per second; `None`: the waves do not move.
    pub fps: Option<f64>,
}

impl Default for Caustics {
    fn default() -> Self {
        Self {
            tile_m: 3.0,
            cells: 128,
            slope: 0.12,
            wind_deg: 0.0,
            fps: None,
        }
    }
}

/// Refractive index of sea water.
pub const REFRACTIVE_INDEX: f64 = 1.34;

/// Cosine from the vertical beyond which no sky is seen, `sqrt(1 − 1/n²)`.
pub const CRITICAL_COSINE: f64 = 0.665_644_869_282_918_2;

/// Reflectance of the sea surface from within the water for light that is not polarized, at a cosine from the vertical: 1 beyond
/// the critical angle (Fresnel).
#[must_use]
pub fn fresnel(cosine: f64) -> f64 {
    let n = REFRACTIVE_INDEX;
    let sine_in_air = n * n * (1.0 - cosine * cosine);
    if sine_in_air >= 1.0 {
        return 1.0;
    }
    let k = (1.0 - sine_in_air).sqrt();
    let across = (n * cosine - k) / (n * cosine + k);
    let along = (cosine - n * k) / (cosine + n * k);
    0.5 * (across * across + along * along)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clouds_and_a_low_sun_lower_its_share() {
        let share = |sun_elevation_deg: f64, cloud_cover: f64| {
            sun_share(&Sky {
                sun_elevation_deg,
                cloud_cover,
                ..Sky::default()
            })
        };
        assert_eq!(share(60.0, 1.0), 0.0);
        assert!((0.8..0.9).contains(&share(60.0, 0.0)), "{}", share(60.0, 0.0));
        assert!(share(60.0, 0.0) > share(20.0, 0.0));
        assert!(share(20.0, 0.0) > share(20.0, 0.5));
    }
}
