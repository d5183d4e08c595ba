//! The sun as the water lets it through.

use imaging::vector::DVec3;

use super::gaze::Gaze;
use super::model::{REFRACTIVE_INDEX, Sun};

/// Sunlight in the water: parallel, with the rest of the irradiance coming from all around.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunLight {
    /// Its share in the irradiance just below the surface, 0..=1.
    pub share: f64,
    /// Cosine of its direction from the vertical in the water, `sqrt(1 − (cos(elevation)/n)²)`.
    pub rise: f64,
    /// Azimuth around the vertical, radians from the first of the level axes to the second.
    pub azimuth: f64,
    /// Whether surfaces cast shadows in it.
    pub casts_shadows: bool,
}

impl SunLight {
    /// The sun of a description.
    #[must_use]
    pub fn new(share: f64, sun: &Sun) -> Self {
        let sine = sun.elevation_deg.to_radians().cos() / REFRACTIVE_INDEX;
        Self {
            share,
            rise: (1.0 - sine * sine).sqrt(),
            azimuth: sun.azimuth_deg.to_radians(),
            casts_shadows: sun.casts_shadows,
        }
    }

    /// The unit vector to the sun in camera axes.
    #[must_use]
    pub fn toward(&self, gaze: &Gaze) -> [f64; 3] {
        let level = (1.0 - self.rise * self.rise).max(0.0).sqrt();
        let [east, north] = gaze.level.map(DVec3::from);
        let (sine, cosine) = self.azimuth.sin_cos();
        (DVec3::from(gaze.up) * self.rise + east * (level * cosine) + north * (level * sine)).into()
    }
}
