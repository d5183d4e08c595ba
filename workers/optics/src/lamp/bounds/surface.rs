//! Bounds of the light of lamps on surfaces.

use super::super::multiple::{surface_depth, surface_scale};
use super::super::{Lamp, Lighting};
use super::cone::{Cone, Passing};
use super::factor::Factor;
use super::profile::{MARGIN, Profile, largest_sine};
use super::{FADE, STEP, most_decayed};
use crate::visible_bounds::{Tile, VisibleBounds};

/// Largest ratio of ranges within a segment of rays, and the largest number of segments; the limit of the number has precedence.
const GROWTH: f64 = 1.12;
const SEGMENTS: usize = 8;
/// The fast form moves surfaces beyond a thousand kilometers to there: light that this changes, as a share of the intensity.
const FARTHEST_M: f64 = 9e5;
const BEYOND: f64 = 1.3e-12;
/// Less of the light than this is lost in f32.
const DARKEST: f64 = 2e-38;
/// Roundings of all factors of the light.
const FACTORS: f64 = 22.0;
/// Roundings of an exponent, and of the cosine to an axis.
const EXPONENT: f64 = 7.0;
const COSINE: f64 = 8.0;
/// Relative error of the power of the loss of scattered light.
const POWER: f64 = 2e-6;
/// Largest change of the kernel's scale above its minimum, per share of the path.
const SCALE_POWER: f64 = 1.4;
/// Error of the blurred profile in f32: alone, and by the slope of the profile.
const BLUR: [f64; 2] = [1e-6, 4e-7];

/// Bounds of the light of lamps on the surfaces of each tile of a view.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceBounds {
    /// Upper bound of the irradiance of each tile, in the fast form and in the reference.
    pub irradiance: Vec<[f64; 3]>,
    /// Upper bound of the difference from the reference in any channel of each tile, without shadow edges.
    pub rounding: Vec<f64>,
}

/// Bounds of [`irradiance`](super::super::irradiance()) from the geometry of the view.
#[must_use]
pub fn bound_irradiance(lighting: &Lighting, view: &VisibleBounds) -> SurfaceBounds {
    let lamps: Vec<Bounded> = (lighting.lamps.iter())
        .map(|lamp| Bounded::new(lamp, lighting))
        .collect();
    let tiles = view.tiles.iter().map(|tile| {
        let mut sum = Arriving::default();
        for lamp in &lamps {
            sum.add(lamp.on_tile(tile));
        }
        sum
    });
    let (irradiance, rounding) = tiles
        .map(|sum| {
            let rounding = sum.rounding.into_iter().fold(0.0, f64::max);
            (sum.light.map(|light| light + rounding), rounding)
        })
        .unzip();
    SurfaceBounds { irradiance, rounding }
}

/// The most light that arrives, and the most that f32 changes of it.
#[derive(Debug, Clone, Copy, Default)]
struct Arriving {
    light: [f64; 3],
    rounding: [f64; 3],
}

impl Arriving {
    /// Adds a lamp, as the fast form does in f32.
    fn add(&mut self, other: Self) {
        for i in 0..3 {
            self.light[i] += other.light[i];
            self.rounding[i] += other.rounding[i] + STEP * self.light[i];
        }
    }

    fn include(&mut self, other: Self) {
        for i in 0..3 {
            self.light[i] = self.light[i].max(other.light[i]);
            self.rounding[i] = self.rounding[i].max(other.rounding[i]);
        }
    }
}

/// A lamp, and its errors in f32.
struct Bounded<'a> {
    lamp: &'a Lamp,
    lighting: &'a Lighting,
    profile: Profile,
    /// Errors of its position in meters, and of tangents of rays by that of the principal point.
    place_error: f64,
    lens_error: f64,
}

/// A segment of rays to a tile.
struct At {
    /// Least and greatest path of light in meters of mean water.
    meters: [f64; 2],
    /// Error of the vector from the lamp, and of the factor of the water, as shares.
    way_error: f64,
    factor_error: f64,
}

impl<'a> Bounded<'a> {
    fn new(lamp: &'a Lamp, lighting: &'a Lighting) -> Self {
        let lost = |v: f64| v - f64::from(v as f32);
        let place = lamp.position_m.map(lost);
        let camera = &lighting.camera;
        Self {
            lamp,
            lighting,
            profile: Profile::new(lamp.beam),
            place_error: place.iter().map(|v| v * v).sum::<f64>().sqrt(),
            lens_error: (lost(camera.cx).abs() + lost(camera.cy).abs()) / camera.focal_px,
        }
    }

    fn on_tile(&self, tile: &Tile) -> Arriving {
        let mut worst = Arriving::default();
        let Some([nearest, farthest]) = tile.range_m else {
            return worst;
        };
        let cone = Cone::new(tile);
        let passing = Passing::new(cone, self.lamp.position_m, self.lighting.radius_m);
        let count = ((farthest / nearest).ln() / GROWTH.ln())
            .ceil()
            .clamp(1.0, SEGMENTS as f64);
        let growth = (farthest / nearest).powf(1.0 / count);
        let factor = Factor::to_surfaces(self.lighting, cone, &passing, [nearest, farthest]);
        let mut from = nearest;
        for segment in 1..=count as usize {
            let to = if segment == count as usize {
                farthest
            } else {
                from * growth
            };
            worst.include(self.on_segment(cone.off_axis, &passing, factor, [from, to]));
            from = to;
        }
        worst
    }

    fn on_segment(&self, off_axis: f64, passing: &Passing, factor: Factor, [from, to]: [f64; 2]) -> Arriving {
        let segment = passing.segment([from.min(FARTHEST_M), to], self.profile.axis);
        let near = segment.near_m;
        let seen = (to / near).min(1.0 + passing.away_m / near);
        // A point has at most 4 roundings of its range across the ray, and 4 along it.
        let place_error = STEP * (1.0 + 4.0 * (1.0 + off_axis * off_axis).sqrt() * seen);
        let at = At {
            meters: [factor.bounds[0] * near, factor.bounds[1] * segment.far_m],
            way_error: place_error + self.place_error / near + self.lens_error * seen,
            factor_error: factor.error_to(seen),
        };
        let mut arriving = self.arriving(&at, segment.to_axis);
        let unit = 1.0 / (near * near);
        for i in 0..3 {
            let intensity = self.lamp.intensity[i];
            arriving.light[i] *= intensity * unit * (1.0 + 1e-6);
            // Errors of higher order where they are not small.
            arriving.rounding[i] *= intensity * unit * (1.0 + 4.0 * at.way_error);
            if to > FARTHEST_M {
                arriving.rounding[i] += BEYOND * intensity;
            }
        }
        arriving
    }

    /// Light at a surface that faces the lamp, over its intensity and the square of the distance.
    fn arriving(&self, at: &At, to_axis: [f64; 2]) -> Arriving {
        let Self {
            profile, lighting, ..
        } = self;
        let direct_profile = profile.most(to_axis, margin_of(at));
        let sine = largest_sine(to_axis).min(profile.sin_cone);
        let cosine_error = COSINE * STEP + profile.axis_error;
        let is_lit = f64::from(u8::from(direct_profile > 0.0));
        let profile_error =
            is_lit * (profile.slope * (cosine_error + sine * at.way_error) + profile.line_error + STEP);
        let share = 2.0 * at.way_error + FACTORS * STEP + FADE;
        let exponent_error = at.way_error + EXPONENT * STEP + at.factor_error;
        let mut arriving = Arriving::default();
        let blurs = lighting
            .absorption
            .map(|a| (a, self.blurs(at, to_axis, cosine_error)));
        for i in 0..3 {
            let depths = at.meters.map(|meters| lighting.attenuation[i] * meters);
            let direct = (-depths[0]).exp();
            let decayed = most_decayed(depths[0], depths[1]);
            let mut light = direct_profile * direct;
            let mut error = profile_error * direct;
            let mut decaying = direct_profile;
            if let Some((a, (blur, blur_error))) = blurs {
                let depths = at
                    .meters
                    .map(|meters| surface_depth(a[i], lighting.scattering[i], meters));
                let all = (-depths[0]).exp();
                let rest = (-lighting.attenuation[i] * at.meters[1]).exp();
                let joined = (all - rest).clamp(0.0, all);
                // With the power of the loss, whose exponent counts 1.7 times.
                let lost = depths[1] - a[i] * at.meters[1];
                let all_error = most_decayed(depths[0], depths[1]) * exponent_error
                    + all * lost * (0.7 * exponent_error + POWER);
                light = (direct_profile.max(blur) * all).min(light + blur * joined);
                error += blur_error * joined + blur * (all_error + FADE * (all + direct));
                // Unscattered light is subtracted from spread light.
                decaying = direct_profile.max(blur);
            }
            error += decaying * exponent_error * decayed;
            arriving.light[i] = light;
            arriving.rounding[i] = error + share * light + DARKEST;
        }
        arriving
    }

    /// The most of the blurred profile, and of its error.
    fn blurs(&self, at: &At, to_axis: [f64; 2], cosine_error: f64) -> (f64, f64) {
        let profile = &self.profile;
        if profile.axis.is_none() {
            return (1.0, 0.0);
        }
        let scattering = self.lighting.scattering;
        let least = scattering.into_iter().fold(f64::INFINITY, f64::min);
        let most = scattering.into_iter().fold(0.0, f64::max);
        let scale = [least * at.meters[0], most * at.meters[1]].map(surface_scale);
        let blurred = profile.blurred(to_axis, scale, margin_of(at));
        let widened = SCALE_POWER * (scale[1] - surface_scale(0.0));
        let scale_error = widened * (at.way_error + 4.0 * STEP + at.factor_error) + 2.0 * STEP * scale[1];
        let turned = blurred.lit * at.way_error + blurred.reach * scale_error;
        let other = profile.slope * (cosine_error + BLUR[1]) + profile.line_error + BLUR[0];
        let error = profile.slope * profile.sin_cone * turned + blurred.lit * other;
        (blurred.most, error)
    }
}

/// Light so far beyond the cone may be there by rounding, rad.
fn margin_of(at: &At) -> f64 {
    MARGIN + 2.0 * at.way_error
}
