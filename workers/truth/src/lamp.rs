//! Lamps as small spheres.

use imaging::vector::DVec3;
use optics::lamp::LAMP_RADIUS_M;
use spec::Light;

/// A spherical lamp, isotropic or with a beam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphereLamp {
    /// Position in camera axes, m.
    pub place: DVec3,
    /// Radiance times m² per steradian, of each channel.
    pub intensity: [f64; 3],
    /// Unit axis, and cosine of the angle where the intensity reaches 0; `None` for an isotropic lamp.
    pub beam: Option<(DVec3, f64)>,
    /// Minimum distance of any surface, m.
    pub radius_m: f64,
    /// Radius of the disc, perpendicular to the line of sight, whose points are sampled for soft shadows; 0: only its
    /// center.
    pub disc_m: f64,
}

impl SphereLamp {
    /// The lamps among the validated lights of a frame.
    #[must_use]
    pub fn among(lights: &[Light]) -> Vec<Self> {
        lights.iter().filter_map(Self::from_light).collect()
    }

    fn from_light(light: &Light) -> Option<Self> {
        match light {
            Light::Haze(_) => None,
            Light::Point(point) => Some(Self::isotropic(point.position_m, point.intensity, point.radius_m)),
            Light::Spot(spot) => {
                let axis = DVec3::from(spot.direction).normalized();
                let cosine = spot.cone_deg.to_radians().cos().max(0.0);
                Some(Self {
                    beam: Some((axis, cosine)),
                    ..Self::isotropic(spot.position_m, spot.intensity, spot.radius_m)
                })
            }
        }
    }

    fn isotropic(place: [f64; 3], intensity: [f64; 3], radius_m: f64) -> Self {
        Self {
            place: place.into(),
            intensity,
            beam: None,
            radius_m: radius_m.max(LAMP_RADIUS_M),
            disc_m: radius_m,
        }
    }

    /// Relative intensity along a unit vector from the lamp: 1, or `clamp((cos − cos cone)/(1 − cos cone), 0, 1)`.
    #[must_use]
    pub fn profile(&self, from_lamp: DVec3) -> f64 {
        self.beam.map_or(1.0, |(axis, cosine)| {
            ((axis.dot(from_lamp) - cosine) / (1.0 - cosine)).clamp(0.0, 1.0)
        })
    }
}
