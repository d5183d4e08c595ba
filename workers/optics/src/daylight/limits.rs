//! Limits of daylight on surfaces, available before daylight is computed.

use super::SurfaceLight;
use super::conditions::Daylight;
use super::slope::SLOPES;
use crate::error_bound::ErrorBound;
use crate::visible_bounds::Tile;

/// One rounding of f32.
const STEP: f64 = 6e-8;
/// Roundings of the light of a surface as a share of it: level, table, exponentials and products.
const FACTORS: f64 = 40.0;
/// Roundings of the cosine between a normal and the sun.
const COSINE: f64 = 4.0;
/// Roundings of the cosine between a normal and the vertical, and of its place in the table by slope.
const PLACE: f64 = 8.0;

/// The surfaces of a part of a picture, from the lowest to the highest above the camera, in the unit of the range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heights {
    /// The lowest.
    pub lowest: f64,
    /// The highest, at most the surface of the sea.
    pub highest: f64,
}

/// Upper bounds of the light of a surface of reflectance 1 in one channel.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MostLight {
    /// Sunlight without caustics: `e σ/μ_s`.
    pub sunlit: f64,
    /// Light from all around: `e (1 − σ) D`.
    pub around: f64,
}

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

    /// The heights of the surfaces of a tile, whose holes show a surface at the range `stand_in` if there is one; `None` without
    /// surfaces.
    #[must_use]
    pub fn tile_heights(&self, tile: &Tile, stand_in: Option<f64>) -> Option<Heights> {
        let [near, far] = match (tile.range_m, stand_in.filter(|_| tile.has_holes)) {
            (Some([near, far]), Some(z)) => [near.min(z), far.max(z)],
            (Some(range), None) => range,
            (None, filled) => [filled?; 2],
        };
        let [low, high] = self.tile_rises(tile);
        Some(Heights {
            lowest: (low * if low < 0.0 { far } else { near }).min(self.depth),
            highest: (high * if high > 0.0 { far } else { near }).min(self.depth),
        })
    }

    /// Least and greatest cosine between the vertical and the rays of a tile.
    fn tile_rises(&self, tile: &Tile) -> [f64; 2] {
        let up = self.gaze.up;
        let [x, y] = [0, 1].map(|i| [tile.low[i] * up[i], tile.high[i] * up[i]]);
        let low = x[0].min(x[1]) + y[0].min(y[1]) + up[2];
        let high = x[0].max(x[1]) + y[0].max(y[1]) + up[2];
        let [least, most] = tile.stretch();
        [
            low / if low < 0.0 { least } else { most },
            high / if high > 0.0 { least } else { most },
        ]
    }

    /// Depths of these heights below the surface of the sea in true meters, the shallowest first.
    #[must_use]
    pub fn depths_of(&self, heights: Heights) -> (f64, f64) {
        let depth = |height: f64| self.scale * (self.depth - height).max(0.0);
        (depth(heights.highest), depth(heights.lowest))
    }

    /// Upper bounds of the light of a surface of reflectance 1 in a channel.
    #[must_use]
    pub fn most_light(&self, channel: usize, heights: Heights) -> MostLight {
        let ends = [heights.lowest, heights.highest];
        let field = &self.fields[channel];
        let arriving = ends.map(|height| self.irradiance(channel, height));
        let most = arriving[0].max(arriving[1]);
        let slope = field.slopes.into_iter().fold(0.0, f64::max);
        let Some(sun) = self.sun else {
            return MostLight {
                sunlit: 0.0,
                around: most * slope,
            };
        };
        // Both factors are exponentials of the height, and so is their product unless the share is clamped somewhere.
        let shares = ends.map(|height| sun.share_at(field, self.depth - height));
        let is_clamped = shares.iter().any(|&share| share >= 1.0);
        let sunlit = if is_clamped {
            most
        } else {
            (arriving[0] * shares[0]).max(arriving[1] * shares[1])
        };
        MostLight {
            sunlit: sunlit / sun.rise,
            around: most * (1.0 - shares[0].min(shares[1])) * slope,
        }
    }

    /// Bound of f32 rounding on surfaces of reflectance 1 in a channel that receive at most this light, with caustics of at most
    /// `peak`: the roundings of cosines, which may cancel.
    #[must_use]
    pub fn cosine_rounding(&self, channel: usize, light: MostLight, peak: f64) -> f64 {
        let slopes = &self.fields[channel].slopes;
        let brightest = slopes.iter().copied().fold(0.0, f64::max).max(f64::MIN_POSITIVE);
        let steps = slopes.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        // The table covers cosines from −1 to 1.
        let steepest = steps.fold(0.0, f64::max) * (SLOPES - 1) as f64 / 2.0;
        STEP * (COSINE * light.sunlit * peak + PLACE * light.around * steepest / brightest)
    }

    /// Bound of f32 rounding on surfaces up to a range, as a share of their light.
    #[must_use]
    pub fn rounding(&self, farthest: f64) -> ErrorBound {
        let rate = |channel: usize| {
            let field = &self.fields[channel];
            field.decay + self.sun.map_or(0.0, |sun| sun.fading(field).abs())
        };
        let steepest = (0..3).map(rate).fold(0.0, f64::max);
        let camera = &self.gaze.camera;
        let lens = (camera.cx.abs() + camera.cy.abs()) / camera.focal_px;
        let place = (8.0 + lens) * steepest * farthest;
        ErrorBound::relative(STEP * (FACTORS + place))
    }
}
