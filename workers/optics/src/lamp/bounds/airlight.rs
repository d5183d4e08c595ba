//! Bounds of the airlight of lamps.

use super::super::multiple::{SATURATION, SWELL, glow_depth, glow_scale};
use super::super::{Lamp, Lighting};
use super::cone::{Cone, Passing};
use super::factor::Factor;
use super::profile::{MARGIN, Profile, largest_sine};
use super::{FADE, STEP, most_decayed};
use crate::error_bound::ErrorBound;
use crate::visible_bounds::VisibleBounds;

/// Side of a block of rays in tiles of the view. One bound holds for all rays of a block.
const BLOCK: usize = 2;
/// Segments of a ray, of equal angles about the lamp.
const SEGMENTS: usize = 14;
/// Roundings of the vector from the ray to the lamp, as a share of its distance from the camera.
const WAY: f64 = 2.0;
/// Roundings of an angle, of the cosine to an axis, and of the exponential and all factors of the light.
const ANGLE: f64 = 6.0;
const COSINE: f64 = 5.0;
const FACTORS: f64 = 12.0;
/// Roundings of an exponent, and of the swelling of light.
const EXPONENT: f64 = 4.0;
const SWOLLEN: f64 = 6.0;
/// The most that light swells by: e to the power of 0.06 · 8.
const MOST_SWELL: f64 = 1.617;
/// Rounding of f32 in the position on an interpolated ray, as a share of the ray.
const PLACE: f64 = 1e-6;
/// Errors that are a greater share of the light are absolute: such light is dark, and the share would hold for all of the picture.
const MOST_RELATIVE: f64 = 1e-5;
/// Two cells of an interpolated ray, in angle about the lamp: the one that a pixel ends in, and one more for the rays around it. A cell
/// is a sixteenth of w at most, and the angle changes by four times w at most.
const END_CELLS: f64 = 2.0 * 4.0 / 16.0;
/// Error of the blurred profile in f32: alone, and by the slope of the profile.
const BLUR: [f64; 2] = [1e-6, 4e-7];

/// Bounds of the airlight of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AirlightBounds {
    /// Upper bound of the airlight of a pixel, without quadrature error.
    pub peak: [f64; 3],
    /// Upper bound of the difference from the reference in any channel, without quadrature error and shadow edges.
    pub rounding: ErrorBound,
}

impl AirlightBounds {
    /// The most of any channel.
    #[must_use]
    pub fn brightest(&self) -> f64 {
        self.peak.into_iter().fold(0.0, f64::max)
    }
}

/// Bounds of [`airlight`](super::super::airlight()) from the geometry of the view.
#[must_use]
pub fn bound_airlight(lighting: &Lighting, view: &VisibleBounds) -> AirlightBounds {
    let blocks = Blocks::new(lighting, view);
    let peak = blocks.all.iter().map(|block| block.light);
    AirlightBounds {
        peak: peak.fold([0.0; 3], |most, light| [0, 1, 2].map(|i| light[i].max(most[i]))),
        rounding: blocks.rounding(),
    }
}

/// Bounds of blocks of rays.
struct Blocks {
    all: Vec<Glow>,
}

/// Bounds of the airlight of a block of rays.
#[derive(Debug, Clone, Copy, Default)]
struct Glow {
    light: [f64; 3],
    rounding: ErrorBound,
}

impl Blocks {
    fn new(lighting: &Lighting, view: &VisibleBounds) -> Self {
        let shining = |lamp: &&Lamp| (0..3).any(|i| lamp.intensity[i] * lighting.scattering[i] > 0.0);
        let lamps: Vec<Bounded> = (lighting.lamps.iter().filter(shining))
            .map(|lamp| Bounded::new(lamp, lighting))
            .collect();
        let tiles = view.merged(BLOCK);
        let all = tiles.iter().map(|tile| {
            let cone = Cone::new(tile);
            let [nearest, farthest] = tile.range_m.unwrap_or([f64::INFINITY; 2]);
            let farthest = if tile.has_holes { f64::INFINITY } else { farthest };
            let mut sum = Glow::default();
            for lamp in &lamps {
                let own = lamp.on_rays(cone, [nearest, farthest]);
                sum.light = [0, 1, 2].map(|i| sum.light[i] + own.light[i]);
                // The greatest share of the light of any lamp is one of their sum, too.
                sum.rounding = ErrorBound {
                    absolute: sum.rounding.absolute + own.rounding.absolute,
                    relative: sum.rounding.relative.max(own.rounding.relative),
                };
            }
            sum.rounding.relative += STEP * lamps.len() as f64;
            sum.light = sum.light.map(|light| light + sum.rounding.bound_sample(light));
            sum
        });
        Self { all: all.collect() }
    }

    /// The most that f32 may change of any pixel.
    fn rounding(&self) -> ErrorBound {
        let roundings = self.all.iter().map(|block| block.rounding);
        roundings.fold(ErrorBound::EXACT, ErrorBound::greater)
    }
}

/// A lamp, and its errors in f32.
struct Bounded<'a> {
    lamp: &'a Lamp,
    lighting: &'a Lighting,
    profile: Profile,
    /// b I₀ of each channel.
    strength: [f64; 3],
    away_m: f64,
    /// Error of the vector from a ray to the lamp, m.
    way_m: f64,
    greatest_attenuation: f64,
}

/// A segment of rays.
struct At {
    /// Least and greatest path of light in meters of mean water.
    path: [f64; 2],
    /// Most of the phase function, 1/sr.
    phase: f64,
    near_m: f64,
    to_axis: [f64; 2],
}

/// Light that a segment sends to the camera per angle about the lamp, times the distance of lamp and ray.
#[derive(Default)]
struct Sent {
    light: [f64; 3],
    /// Errors of profile, exponents and differences.
    error: f64,
}

impl<'a> Bounded<'a> {
    fn new(lamp: &'a Lamp, lighting: &'a Lighting) -> Self {
        let camera = &lighting.camera;
        let lost = |place: f64| (place - f64::from(place as f32)).abs();
        let lens = (lost(camera.cx) + lost(camera.cy)) / camera.focal_px;
        let away_m = lamp.distance_m();
        Self {
            lamp,
            lighting,
            profile: Profile::new(lamp.beam),
            strength: [0, 1, 2].map(|i| lighting.scattering[i] * lamp.intensity[i]),
            away_m,
            way_m: (STEP * WAY + lens) * away_m,
            greatest_attenuation: lighting.attenuation.into_iter().fold(0.0, f64::max),
        }
    }

    /// On all rays of a cone that end between two ranges.
    fn on_rays(&self, cone: Cone, [nearest, farthest]: [f64; 2]) -> Glow {
        let passing = Passing::new(cone, self.lamp.position_m, self.lighting.radius_m);
        let factors = Factor::of_airlight(self.lighting, cone, &passing, [nearest, farthest]);
        let [factor, source] = factors.map(|factor| factor.bounds);
        let beside = passing.beside_m();
        let (first, last) = (passing.angle_at(0.0), passing.angle_at(farthest));
        let step = (last - first) / SEGMENTS as f64;
        let end_cells_m = passing.least_range_before(nearest, END_CELLS);
        let (mut glow, mut most) = (Glow::default(), 0.0f64);
        let (mut at_end, mut in_end_cells) = (0.0f64, 0.0f64);
        let (mut from, mut errors) = (0.0, 0.0);
        for segment in 1..=SEGMENTS {
            let to = match segment {
                SEGMENTS => farthest,
                _ => passing.range_at(first + step * segment as f64).min(farthest),
            };
            if to <= from {
                continue;
            }
            let own = passing.segment([from, to], self.profile.axis);
            let cosines = passing.scattering_cosines([from, to]);
            let at = At {
                path: [factor[0] * own.path_m[0], factor[1] * own.path_m[1]],
                phase: cosines
                    .map(|cos| self.lighting.phase.most(cos))
                    .into_iter()
                    .fold(0.0, f64::max),
                near_m: own.near_m,
                to_axis: own.to_axis,
            };
            let sent = self.sent(&at);
            let turned = passing.most_turned([from, to]);
            let greatest = sent.light.into_iter().fold(0.0, f64::max);
            glow.light = [0, 1, 2].map(|i| glow.light[i] + turned * sent.light[i]);
            errors += turned * sent.error;
            most = most.max(greatest);
            if to >= nearest {
                at_end = at_end.max(greatest);
            }
            if to >= end_cells_m {
                in_end_cells = in_end_cells.max(greatest);
            }
            from = to;
        }
        glow.light = glow.light.map(|light| source[1] * light * (1.0 + 1e-6));
        let least_end = passing.least_distance([nearest.min(1e9), farthest]);
        let ends = most * (ANGLE * STEP + self.way_m / self.away_m.max(beside))
            + at_end * ((ANGLE + 1.0) * STEP + self.way_m / least_end)
            + self.read(in_end_cells);
        let shares = self.shares(&passing, factors, farthest);
        let greatest = glow.light.into_iter().fold(0.0, f64::max);
        let factors = if shares <= MOST_RELATIVE {
            ErrorBound::relative(shares)
        } else {
            ErrorBound::absolute(shares * greatest)
        };
        glow.rounding = factors.plus(ErrorBound::absolute(source[1] * (ends / beside + errors)));
        glow
    }

    /// Error of light interpolated between rays, from the position along the ray.
    fn read(&self, most: f64) -> f64 {
        if self.lighting.absorption.is_some() {
            4.0 * PLACE * most
        } else {
            0.0
        }
    }

    /// Errors of the factors, as a share of the light.
    fn shares(&self, passing: &Passing, [path, source]: [Factor; 2], farthest: f64) -> f64 {
        let meters = self.greatest_attenuation * path.bounds[1] * self.away_m;
        let beside = passing.beside_m();
        let moved = if passing.is_behind() {
            (1.5 / beside).min(3.5 / passing.least_distance([0.0, farthest]))
        } else {
            1.5 / beside
        };
        let patches = meters * path.error() + source.error();
        STEP * (FACTORS + EXPONENT * meters) + moved * self.way_m + patches
    }

    fn sent(&self, at: &At) -> Sent {
        let Self {
            profile, lighting, ..
        } = self;
        let margin = MARGIN + 2.0 * self.way_m / at.near_m;
        let direct_profile = profile.most(at.to_axis, margin);
        let sine = largest_sine(at.to_axis).min(profile.sin_cone);
        let way = self.way_m / at.near_m;
        let cosine = profile.slope * (COSINE * STEP + profile.axis_error + sine * (2.0 * ANGLE * STEP + way))
            + profile.line_error;
        let is_lit = f64::from(u8::from(direct_profile > 0.0));
        let mut sent = Sent::default();
        let spreads = lighting
            .absorption
            .map(|a| [0, 1, 2].map(|i| self.spread(a[i], i, at)));
        // For all channels together, by the widest of their kernels.
        let widest = spreads.map_or(0.0, |spreads| {
            spreads.iter().map(|[scale, _]| *scale).fold(0.0, f64::max)
        });
        let blurred = profile.blurred(at.to_axis, [glow_scale(0.0), widest.max(glow_scale(0.0))], margin);
        if direct_profile <= 0.0 && (spreads.is_none() || blurred.lit <= 0.0) {
            return sent;
        }
        for i in 0..3 {
            let depths = at.path.map(|path| lighting.attenuation[i] * path);
            let direct = (-depths[0]).exp();
            let decayed = most_decayed(depths[0], depths[1]);
            let strength = self.strength[i] * at.phase;
            let mut light = direct_profile * direct;
            let mut error = is_lit * cosine * direct + direct_profile * EXPONENT * STEP * decayed;
            if let (Some(a), Some(spreads)) = (lighting.absorption, spreads) {
                let [_, all] = spreads[i];
                let all_error = self.spread_error(a[i], at) + SWOLLEN * STEP * all;
                if profile.axis.is_none() {
                    (light, error) = (all, all_error);
                } else {
                    let rest = (-depths[1]).exp();
                    let joined = (all - rest).max(0.0);
                    light = (direct_profile.max(blurred.most) * all).min(light + blurred.most * joined);
                    let blur = blurred.lit * (cosine + profile.slope * BLUR[1] + BLUR[0]);
                    error += blur * joined
                        + blurred.most * (FADE * (all + direct) + EXPONENT * STEP * decayed + all_error);
                }
            }
            sent.light[i] = strength * light;
            sent.error = sent.error.max(strength * error);
        }
        sent
    }

    /// Error of forward-scattered light due to the error of its exponent.
    fn spread_error(&self, absorption: f64, at: &At) -> f64 {
        let [least, most] = at.path.map(|path| absorption * path);
        EXPONENT * STEP * MOST_SWELL * most_decayed(least, most)
    }

    /// The widest scale of the kernel, and the largest share of forward-scattered light.
    fn spread(&self, absorption: f64, channel: usize, at: &At) -> [f64; 2] {
        let b = self.lighting.scattering[channel];
        // Where light swells by more than it is absorbed it is most farther on.
        let latest = SATURATION * ((SWELL * b / absorption.max(1e-12)).sqrt() - 1.0) / b.max(1e-12);
        let path = latest.clamp(at.path[0], at.path[1]).min(1e9);
        [
            glow_scale(b * at.path[1]),
            (-glow_depth(absorption, b, path)).exp(),
        ]
    }
}
