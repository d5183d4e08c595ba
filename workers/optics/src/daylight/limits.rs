//! Limits of daylight on surfaces, available before daylight is computed.

use super::SurfaceLight;
use super::conditions::Daylight;
use crate::error_bound::ErrorBound;

/// One rounding of f32.
const STEP: f64 = 6e-8;
/// Roundings of the light of a surface as a share of it: level, table, exponentials and products.
const FACTORS: f64 = 40.0;
/// Roundings of the cosines between a normal and the sun, and of a normal and the vertical times the steepest slope of the table.
const COSINE: f64 = 4.0;
const SLOPE: f64 = 16.0;

impl Daylight {
    /// Whether rays are traced for shadows of the sun, ambient occlusion or occlusion of the veil.
    #[must_use]
    pub fn traces_rays(&self) -> bool {
        let casts_shadows = self.sun.is_some_and(|sun| sun.casts_shadows);
        self.occludes_veil || self.surfaces == SurfaceLight::Normal && (casts_shadows || self.rays > 0)
    }

    /// Rays of ambient occlusion from each point.
    #[must_use]
    pub fn ambient_rays(&self) -> usize {
        self.rays
    }

    /// The highest and the lowest point up to a range, above the camera.
    fn heights(&self, farthest: f64) -> [f64; 2] {
        let (low, high) = self.gaze.rises;
        [
            (high.max(0.0) * farthest).min(self.depth),
            low.min(0.0) * farthest,
        ]
    }

    /// Upper bound of the light of a surface of reflectance 1 in a channel, for caustics of at most this peak: `e max(peak/μ_s,
    /// D)`, since sun and sky share the irradiance.
    #[must_use]
    pub fn most_light(&self, channel: usize, farthest: f64, peak: f64) -> f64 {
        let [highest, lowest] = self.heights(farthest);
        let most = self
            .irradiance(channel, highest)
            .max(self.irradiance(channel, lowest));
        let around = self.fields[channel].slopes.into_iter().fold(0.0, f64::max);
        most * self.sun.map_or(around, |sun| around.max(peak / sun.rise))
    }

    /// Upper bound of the sunlight on a surface of reflectance 1 in a channel, without caustics.
    #[must_use]
    pub fn most_sunlight(&self, channel: usize, farthest: f64) -> f64 {
        let Some(sun) = self.sun else { return 0.0 };
        let ends = self.heights(farthest);
        let field = &self.fields[channel];
        // Both factors are exponentials of the height, and so is their product.
        let share = |height: f64| sun.share_at(field, self.depth - height);
        let arriving = |height: f64| self.irradiance(channel, height) / sun.rise;
        let most = ends
            .iter()
            .map(|&height| share(height) * arriving(height))
            .fold(0.0, f64::max);
        // If the share is clamped somewhere, the product has a kink.
        let is_clamped = ends.iter().any(|&height| share(height) >= 1.0);
        if is_clamped {
            ends.iter().map(|&height| arriving(height)).fold(0.0, f64::max)
        } else {
            most
        }
    }

    /// Bound of f32 rounding on surfaces of at most this reflectance up to a range: a share of their light, and the roundings of
    /// cosines that may cancel.
    #[must_use]
    pub fn rounding(&self, reflectance: [f32; 3], farthest: f64, peak: f64) -> ErrorBound {
        let rate = |channel: usize| {
            let field = &self.fields[channel];
            field.decay + self.sun.map_or(0.0, |sun| sun.fading(field).abs())
        };
        let steepest = (0..3).map(rate).fold(0.0, f64::max);
        let camera = &self.gaze.camera;
        let lens = (camera.cx.abs() + camera.cy.abs()) / camera.focal_px;
        let place = (8.0 + lens) * steepest * farthest;
        let sunny = self.sun.map_or(0.0, |sun| COSINE * peak / sun.rise);
        let cosines = SLOPE + sunny;
        let [highest, lowest] = self.heights(farthest);
        let most = |channel: usize| {
            let irradiance = self
                .irradiance(channel, highest)
                .max(self.irradiance(channel, lowest));
            f64::from(reflectance[channel]) * irradiance
        };
        ErrorBound {
            absolute: STEP * cosines * (0..3).map(most).fold(0.0, f64::max),
            relative: STEP * (FACTORS + place),
        }
    }
}
