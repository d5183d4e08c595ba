//! The light of lamps at points in the water, for particles.
//!
//! A particle is lit like a white surface that faces the lamp: by the visible share of the lamp, and by the visible share of the
//! disc of scattered lamp light.

use std::f64::consts::PI;

use imaging::rays::{RayStart, Rays, offset};
use imaging::vector::dot;

use super::multiple::{blurred, surface_depth, surface_scale};
use super::patches::last;
use super::shadow::{SPREAD_PLACES, Shadow, share_seen};
use super::sight::{Disc, Radius, Sight, Starts};
use super::{Lamp, Lighting};
use crate::lit_point::LitPoint;

/// Light of one lamp at a point, of each channel, as the radiance of a white surface that faces the lamp.
pub(super) struct Arriving {
    /// That was not scattered.
    pub(super) direct: [f64; 3],
    /// Scattered lamp light, and the radius of its disc at the lamp, m.
    pub(super) spread: [f64; 3],
    spread_m: [f64; 3],
}

/// A point as the camera sees it.
#[derive(Clone, Copy)]
pub(super) struct SeenPoint {
    /// Unit vector from the camera.
    ray: [f64; 3],
    range_m: f64,
    place: [f64; 3],
    /// Path from the camera through mean water, m; the range without patches.
    path_m: f64,
}

impl SeenPoint {
    /// A point on a ray from the camera, a unit vector and the range there.
    pub(super) fn new((ray, range_m): ([f64; 3], f64), place: [f64; 3], lighting: &Lighting) -> Self {
        let patches = lighting.patches.as_ref();
        Self {
            ray,
            range_m,
            place,
            path_m: patches.map_or(range_m, |field| field.path_m(ray, range_m)),
        }
    }

    fn locate(place: [f64; 3], lighting: &Lighting) -> Self {
        let range_m = dot(place, place).sqrt().max(lighting.radius_m);
        Self::new((place.map(|v| v / range_m), range_m), place, lighting)
    }

    /// Mean of the patches over the last `leg_m` meters of its ray.
    fn murk(&self, leg_m: f64, lighting: &Lighting) -> f64 {
        let (from, to) = last(self.range_m, leg_m);
        lighting.patches.as_ref().map_or(1.0, |field| {
            (self.path_m - field.path_m(self.ray, from)) / (to - from)
        })
    }
}

impl Arriving {
    pub(super) fn new(point: &SeenPoint, lamp: &Lamp, lighting: &Lighting) -> Self {
        let away = [0, 1, 2].map(|i| point.place[i] - lamp.position_m[i]);
        let distance = dot(away, away).sqrt().max(lighting.radius_m);
        let murk = point.murk(distance, lighting);
        let cosine = |axis: [f64; 3]| dot(axis, away) / distance;
        let profile = lamp.beam.profile(cosine);
        let sphere = PI * distance * distance;
        let mut arriving = Self {
            direct: [0.0; 3],
            spread: [0.0; 3],
            spread_m: [0.0; 3],
        };
        for i in 0..3 {
            let direct = (-lighting.attenuation[i] * murk * distance).exp();
            arriving.direct[i] = lamp.intensity[i] * profile * direct / sphere;
            if let Some(a) = lighting.absorption {
                let (b, meters) = (lighting.scattering[i], murk * distance);
                let scale = surface_scale(b * meters);
                let spread = blurred(lamp.beam, scale, cosine);
                let all = (-surface_depth(a[i], b, meters)).exp();
                arriving.spread[i] = lamp.intensity[i] * spread * (all - direct).max(0.0) / sphere;
                arriving.spread_m[i] = distance * scale;
            }
        }
        arriving
    }
}

/// Radiance of a white particle lit by lamps at a point in camera axes: `I₀ S V e^{−c r}/(π r²)`, like a white surface that faces
/// the lamp, plus scattered lamp light if it is modeled. V is the share of a shadow-casting lamp visible to `rays`, 1 without rays;
/// for scattered light, of its disc.
#[must_use]
pub fn white_at(place: [f64; 3], lighting: &Lighting, rays: Option<&dyn Rays>) -> [f64; 3] {
    let start = RayStart {
        origin: place,
        from: offset(place),
    };
    let point = SeenPoint::locate(place, lighting);
    let mut sum = [0.0; 3];
    for lamp in &lighting.lamps {
        let Arriving {
            direct,
            spread,
            spread_m,
        } = Arriving::new(&point, lamp, lighting);
        let rays = rays.filter(|_| lamp.shadow != Shadow::None);
        let seen = |light: f64, disc| match rays.filter(|_| light > 0.0) {
            Some(rays) => share_seen(rays, start, lamp.position_m, disc),
            None => 1.0,
        };
        let seen_lamp = seen(direct.into_iter().fold(0.0, f64::max), lamp.shadow.disc());
        for i in 0..3 {
            sum[i] += direct[i] * seen_lamp;
            if lighting.absorption.is_some() {
                sum[i] += spread[i] * seen(spread[i], (spread_m[i], SPREAD_PLACES));
            }
        }
    }
    sum
}

/// [`white_at`] of many points, with shadows traced in f32 as by [`shaded_irradiance`](super::shaded_irradiance): light of a lamp
/// that changes no pixel by more than `unseen` is never occluded.
#[must_use]
pub fn white_at_each(
    points: &[LitPoint],
    lighting: &Lighting,
    (rays, unseen): (&dyn Rays, f64),
) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; points.len()];
    let (mut sight, mut asked) = (Sight::new(rays), Asked::new(points));
    let seen = points
        .iter()
        .map(|point| SeenPoint::locate(point.place, lighting));
    let seen: Vec<SeenPoint> = seen.collect();
    for lamp in &lighting.lamps {
        let arriving = seen.iter().map(|point| Arriving::new(point, lamp, lighting));
        let mut arriving: Vec<Arriving> = arriving.collect();
        if lamp.shadow != Shadow::None {
            cut_off(&mut arriving, (lamp, &mut asked), &mut sight, unseen);
        }
        for (sum, Arriving { direct, spread, .. }) in sums.iter_mut().zip(&arriving) {
            for i in 0..3 {
                sum[i] += direct[i];
                sum[i] += spread[i];
            }
        }
    }
    sums
}

/// Points for shadow rays to a lamp.
struct Asked<'a> {
    points: &'a [LitPoint],
    /// Indices of all points in an order that keeps neighbors in space together, for coherent ray packets.
    order: Vec<usize>,
    /// Indices of the ray origins.
    at: Vec<usize>,
    starts: Starts,
}

impl<'a> Asked<'a> {
    fn new(points: &'a [LitPoint]) -> Self {
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by_cached_key(|&at| curve(points[at].place));
        Self {
            points,
            order,
            at: Vec::new(),
            starts: Starts::default(),
        }
    }

    /// Lists the points where the brightest of this light is above `unseen`.
    fn list(&mut self, unseen: f64, light: impl Fn(usize) -> f64) {
        let points = self.points;
        self.at.clear();
        let is_lit = |at: &usize| light(*at) * points[*at].weight > unseen;
        self.at.extend(self.order.iter().copied().filter(is_lit));
        self.starts.clear();
        for &at in &self.at {
            self.starts.push(points[at].place.map(|v| v as f32));
        }
    }
}

/// Position on a space-filling curve about the camera: the interleaved bits of its coordinates (Morton 1966).
fn curve(place: [f64; 3]) -> u64 {
    const CUBE_M: f64 = 0.05;
    const BITS: u32 = 14;
    let cubes = place
        .map(|v| (v / CUBE_M + f64::from(1 << (BITS - 1))).clamp(0.0, f64::from((1 << BITS) - 1)) as u64);
    let bits = (0..BITS).flat_map(|bit| [0, 1, 2].map(|axis| (bit, axis)));
    bits.fold(0, |code, (bit, axis)| {
        code | (cubes[axis] >> bit & 1) << (3 * bit + axis as u32)
    })
}

/// Subtracts the occluded light of a lamp at points.
fn cut_off(
    arriving: &mut [Arriving],
    (lamp, asked): (&Lamp, &mut Asked<'_>),
    sight: &mut Sight<'_>,
    unseen: f64,
) {
    let middle = lamp.position_m.map(|v| v as f32);
    let mut shares = Vec::new();
    asked.list(unseen, |at| arriving[at].direct.into_iter().fold(0.0, f64::max));
    let (radius_m, count) = lamp.shadow.disc();
    let disc = (&Disc::new(count), Radius::Same(radius_m as f32));
    sight.shares(&asked.starts, middle, disc, &mut shares);
    for (&at, &share) in asked.at.iter().zip(&shares) {
        arriving[at].direct = arriving[at].direct.map(|light| light * f64::from(share));
    }
    let disc = Disc::new(SPREAD_PLACES);
    for channel in 0..3 {
        asked.list(unseen, |at| arriving[at].spread[channel]);
        let radii = asked.at.iter().map(|&at| arriving[at].spread_m[channel] as f32);
        let radii: Vec<f32> = radii.collect();
        sight.shares(&asked.starts, middle, (&disc, Radius::Of(&radii)), &mut shares);
        for (&at, &share) in asked.at.iter().zip(&shares) {
            arriving[at].spread[channel] *= f64::from(share);
        }
    }
}

/// Upper bound of [`white_at`]: every lamp at its surface.
#[must_use]
pub fn most_white(lighting: &Lighting) -> [f64; 3] {
    let nearest = PI * lighting.radius_m * lighting.radius_m;
    [0, 1, 2].map(|i| lighting.lamps.iter().map(|lamp| lamp.intensity[i]).sum::<f64>() / nearest)
}
