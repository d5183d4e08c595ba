//! A flat sea surface with a sky and a sun.

use imaging::vector::DVec3;
pub use optics::daylight::{REFRACTIVE_INDEX, fresnel};

/// A flat surface above the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sea {
    /// Unit vector against gravity, camera axes.
    pub up: DVec3,
    /// Depth of the camera below the surface, m.
    pub depth_m: f64,
    /// Radiance of a uniform sky per channel inside the water, `n² E₀/π` for the irradiance E₀ just above the surface,
    /// before surface reflection.
    pub sky: [f64; 3],
    /// The sun; `None` under an overcast sky.
    pub sun: Option<SeaSun>,
}

/// Parallel light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeaSun {
    /// Unit vector toward the sun in the water, camera axes.
    pub direction: DVec3,
    /// Irradiance perpendicular to it just below the surface, per channel.
    pub irradiance: [f64; 3],
}

impl Sea {
    /// Depth of a point below the surface, at least 0, m.
    #[must_use]
    pub fn depth(&self, place: DVec3) -> f64 {
        (self.depth_m - self.up.dot(place)).max(0.0)
    }

    /// Distance along a unit vector to the surface; `None` downward.
    pub(crate) fn distance(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        let rise = self.up.dot(direction);
        (rise > 0.0).then(|| self.depth(origin) / rise)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_surface_reflects_two_percent_upright_and_all_beyond_the_critical_angle() {
        assert!((fresnel(1.0) - (0.34f64 / 2.34).powi(2)).abs() < 1e-12);
        let critical = (1.0 - 1.0 / REFRACTIVE_INDEX.powi(2)).sqrt();
        assert!((critical - 0.6656).abs() < 1e-4);
        assert!(fresnel(critical + 1e-3) < 1.0 && fresnel(critical - 1e-6) == 1.0);
    }
}
