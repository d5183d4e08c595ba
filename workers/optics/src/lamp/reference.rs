//! Lamps in f64 with many nodes. It shares only the definitions with the fast form.

use std::f64::consts::FRAC_PI_2;

use imaging::geometry::Intrinsics;
use imaging::rays::{self, RayStart, Rays};
use imaging::vector::dot;
use imaging::{Plane, Rgb};

use super::beam::Beam;
use super::multiple::{self, glow_scale, surface_scale};
use super::patches::{glow_within, last, mean};
use super::shadow::{SPREAD_PLACES, Shadow, disc_place, sees, share_seen};
use super::{Lamp, Lighting};
use crate::legendre::gauss_legendre;
use crate::range::is_hole;

/// Node count that makes the reference exact to 1e-9 of a lamp's peak for g up to 0.98.
pub const REFERENCE_NODES: usize = 128;
/// Parts between two edges of the integrand, each with the full number of nodes.
const PARTS: usize = 8;
const PART_NODES: usize = 16;
/// Parts of a ray without shadows, and halvings of the last one towards its end: the blur of spread light grows with its path, and
/// it has kinks where a part of it leaves the cone.
const FINE_PARTS: usize = 32;
const FINE_HALVINGS: i32 = 6;
/// Cones below this angle need finer parts, rad: at 10° the edge of the cone within a part cost 2e-4 of the light.
const NARROW: f64 = 0.26;
/// Steps of the search for shadow edges along a ray, and the precision of an edge.
const SEARCH_STEPS: usize = 64;
const EDGE: f64 = 1e-9;

/// The glow of the water before the lamps, radiance in linear light: for a ray along the unit vector d up to the range Z (infinite at
/// a hole), with t₀ = d·P and D the distance of the lamp from the ray,
/// `L = (b I₀/D) ∫ S p(−sin θ) e^{−c (t₀ + D tan θ + D/cos θ)} dθ` from `atan(−t₀/D)` to `atan((Z − t₀)/D)`,
/// by Gauss–Legendre quadrature with `nodes` nodes (single scattering: Sun et al. 2005, Eq. 7-10). In patchy water b and c are those of
/// the ray, see [`glow_within`]. If the lighting has an absorption, multiple scattering is added. Shadows are ignored.
#[must_use]
pub fn airlight_reference(range: &Plane<f64>, lighting: &Lighting, nodes: usize) -> Rgb<f64> {
    airlight(range, lighting, nodes, None)
}

/// [`airlight_reference`] with shadows of the lamps in the water, traced by `rays`.
#[must_use]
pub fn shaded_airlight_reference(
    range: &Plane<f64>,
    lighting: &Lighting,
    nodes: usize,
    rays: &dyn Rays,
) -> Rgb<f64> {
    airlight(range, lighting, nodes, Some(rays))
}

fn airlight(range: &Plane<f64>, lighting: &Lighting, nodes: usize, rays: Option<&dyn Rays>) -> Rgb<f64> {
    let rules = Rules {
        whole: gauss_legendre(nodes),
        part: gauss_legendre(PART_NODES),
    };
    Rgb::from_fn(range.width(), range.height(), |x, y| {
        let (ray, z) = (direction(&lighting.camera, x, y), range.pixel(x, y));
        let z = if is_hole(z) { f64::INFINITY } else { z };
        let mut sum = [0.0; 3];
        for lamp in &lighting.lamps {
            let rays = rays.filter(|_| lamp.glow_shadow);
            let glow = Glow::new(ray, z, lamp, lighting, rays.is_some()).integral(&rules, rays);
            sum.iter_mut().zip(glow).for_each(|(sum, glow)| *sum += glow);
        }
        sum
    })
}

/// Single scattering on the ray of a pixel that ends at this range, without shadows, by one rule over the whole ray.
pub(super) fn light_of_ray(
    (x, y): (usize, usize),
    range_m: f64,
    lighting: &Lighting,
    rule: &[(f64, f64)],
) -> [f64; 3] {
    let ray = direction(&lighting.camera, x, y);
    let end = if is_hole(range_m) { f64::INFINITY } else { range_m };
    let mut sum = [0.0; 3];
    for lamp in &lighting.lamps {
        let glow = Glow::new(ray, end, lamp, lighting, false);
        let [from, to] = glow.ends;
        if to > from {
            let light = glow.between([from, to], rule);
            (0..3).for_each(|i| sum[i] += light[i]);
        }
    }
    sum
}

/// Rules of the quadrature: over a whole ray, and over a part of it.
struct Rules {
    whole: Vec<(f64, f64)>,
    part: Vec<(f64, f64)>,
}

/// The airlight of one lamp along one ray.
struct Glow<'a> {
    lamp: &'a Lamp,
    lighting: &'a Lighting,
    ray: [f64; 3],
    /// t₀, D, and the vector from the lamp to the nearest point of the ray.
    nearest: f64,
    distance: f64,
    offset: [f64; 3],
    /// Angles of the ray's ends, clipped to the lit part.
    ends: [f64; 2],
    /// The factors of b and c.
    source: f64,
    murk: f64,
}

impl<'a> Glow<'a> {
    fn new(ray: [f64; 3], z: f64, lamp: &'a Lamp, lighting: &'a Lighting, in_parts: bool) -> Self {
        let place = lamp.position_m;
        let nearest = dot(ray, place);
        let offset = [0, 1, 2].map(|i| nearest * ray[i] - place[i]);
        let distance = dot(offset, offset).sqrt().max(lighting.radius_m);
        let mut ends = [(-nearest / distance).atan(), ((z - nearest) / distance).atan()];
        if let (Beam::Spot { axis, cos_cone }, None, false) = (lamp.beam, lighting.absorption, in_parts) {
            // Within the cone: where M cos(θ − φ) exceeds cos cone. Including the outside would add an edge to the quadrature.
            let (across, along) = (dot(axis, offset) / distance, dot(axis, ray));
            let (most, middle) = (across.hypot(along), along.atan2(across));
            let half = (cos_cone / most).min(1.0).acos();
            ends = if most <= cos_cone {
                [0.0; 2]
            } else {
                [ends[0].max(middle - half), ends[1].min(middle + half)]
            };
        }
        let patches = lighting.patches.as_ref();
        let (begin, end) = glow_within(z, nearest, distance, lighting.phase.asymmetry);
        Self {
            lamp,
            lighting,
            ray,
            nearest,
            distance,
            offset,
            ends,
            source: mean(patches, ray, (begin, end)),
            murk: mean(patches, ray, (0.0, end)),
        }
    }

    fn integral(&self, rules: &Rules, rays: Option<&dyn Rays>) -> [f64; 3] {
        let [from, to] = self.ends;
        if to <= from {
            return [0.0; 3];
        }
        let has_edges = self.lighting.absorption.is_some() && self.lamp.beam != Beam::Point;
        let Some(rays) = rays else {
            return if has_edges {
                self.in_fine_parts([from, to], rules)
            } else {
                self.between([from, to], &rules.whole)
            };
        };
        let (radius_m, count) = self.lamp.shadow.disc();
        let mut sum = [0.0; 3];
        for k in 0..count {
            let lit = |theta: f64| self.is_lit(theta, rays, radius_m, (k, count));
            for piece in lit_pieces([from, to], lit) {
                let light = self.in_parts(piece, rules);
                (0..3).for_each(|i| sum[i] += light[i] / count as f64);
            }
        }
        sum
    }

    /// Whether a point of the lamp is visible from the point of the ray at an angle. The surface at the end of the ray does not
    /// occlude.
    fn is_lit(&self, theta: f64, rays: &dyn Rays, radius_m: f64, place: (usize, usize)) -> bool {
        let along = self.nearest + self.distance * theta.tan();
        let origin = self.ray.map(|v| v * along);
        let way = [0, 1, 2].map(|i| self.lamp.position_m[i] - origin[i]);
        let meters = dot(way, way).sqrt();
        let target = if radius_m == 0.0 || meters == 0.0 {
            self.lamp.position_m
        } else {
            disc_place(self.lamp.position_m, way.map(|v| v / meters), radius_m, place)
        };
        let from = rays::offset(origin);
        sees(rays, RayStart { origin, from }, target)
    }

    fn in_fine_parts(&self, [from, to]: [f64; 2], rules: &Rules) -> [f64; 3] {
        let finer = self.narrow_cone().map_or(1, |(_, finer)| finer);
        let count = FINE_PARTS * finer;
        let step = (to - from) / count as f64;
        let equal = (0..count).map(|part| from + step * part as f64);
        let halved = (1..=FINE_HALVINGS).map(|half| to - step * 0.5f64.powi(half));
        let edges = self.narrow_cone().map(|(edges, _)| edges);
        let edges = edges
            .into_iter()
            .flatten()
            .filter(|&edge| edge > from && edge < to);
        let mut ends: Vec<f64> = equal.chain(halved).chain(edges).chain([to]).collect();
        ends.sort_by(f64::total_cmp);
        let mut sum = [0.0; 3];
        for part in ends.windows(2) {
            let light = self.between([part[0], part[1]], &rules.part);
            (0..3).for_each(|i| sum[i] += light[i]);
        }
        sum
    }

    /// The angles at the entry and exit of a narrow cone, and the factor for finer parts.
    fn narrow_cone(&self) -> Option<([f64; 2], usize)> {
        let Beam::Spot { axis, cos_cone } = self.lamp.beam else {
            return None;
        };
        let cone = cos_cone.acos();
        if cone >= NARROW {
            return None;
        }
        let across = dot(axis, self.offset) / self.distance;
        let along = dot(axis, self.ray);
        let (most, middle) = (across.hypot(along), along.atan2(across));
        let half = (cos_cone / most.max(f64::MIN_POSITIVE)).min(1.0).acos();
        Some(([middle - half, middle + half], (NARROW / cone).ceil() as usize))
    }

    fn in_parts(&self, [from, to]: [f64; 2], rules: &Rules) -> [f64; 3] {
        let step = (to - from) / PARTS as f64;
        let mut sum = [0.0; 3];
        for part in 0..PARTS {
            let begin = from + step * part as f64;
            let light = self.between([begin, begin + step], &rules.part);
            (0..3).for_each(|i| sum[i] += light[i]);
        }
        sum
    }

    fn between(&self, [from, to]: [f64; 2], rule: &[(f64, f64)]) -> [f64; 3] {
        let Self { lamp, lighting, .. } = *self;
        let mut sum = [0.0; 3];
        for (node, weight) in rule {
            let theta = 0.5 * (from + to) + 0.5 * (to - from) * node;
            let (sin, cos) = theta.sin_cos();
            let cosine =
                |axis: [f64; 3]| cos * dot(axis, self.offset) / self.distance + sin * dot(axis, self.ray);
            let profile = lamp.beam.profile(cosine);
            let path = self.nearest + self.distance * (theta.tan() + 1.0 / cos);
            let phase = lighting.phase.density(-sin);
            let scattered = weight * profile * phase;
            for (i, sum) in sum.iter_mut().enumerate() {
                let direct = (-lighting.attenuation[i] * self.murk * path).exp();
                *sum += scattered * direct;
                if let Some(a) = lighting.absorption {
                    let (b, meters) = (lighting.scattering[i], self.murk * path);
                    let spread = multiple::blurred(lamp.beam, glow_scale(b * meters), cosine);
                    let all = (-multiple::glow_depth(a[i], b, meters)).exp();
                    *sum += weight * phase * spread * (all - direct).max(0.0);
                }
            }
        }
        let Self { source, distance, .. } = *self;
        [0, 1, 2].map(|i| {
            source * lighting.scattering[i] * lamp.intensity[i] / distance * 0.5 * (to - from) * sum[i]
        })
    }
}

/// The stretches of an interval that are lit: edges are searched in [`SEARCH_STEPS`] steps and then halved.
fn lit_pieces([from, to]: [f64; 2], lit: impl Fn(f64) -> bool) -> Vec<[f64; 2]> {
    // An infinite ray is cut before its end.
    let to = to.min(FRAC_PI_2 - 1e-9);
    let at = |step: usize| from + (to - from) * step as f64 / SEARCH_STEPS as f64;
    let mut pieces = Vec::new();
    let (mut begin, mut was_lit) = (from, lit(from));
    for step in 1..=SEARCH_STEPS {
        let is_lit = lit(at(step));
        if is_lit != was_lit {
            let (mut low, mut high) = (at(step - 1), at(step));
            while high - low > EDGE {
                let middle = 0.5 * (low + high);
                if lit(middle) == was_lit {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            if was_lit {
                pieces.push([begin, high]);
            }
            (begin, was_lit) = (high, is_lit);
        }
    }
    if was_lit {
        pieces.push([begin, to]);
    }
    pieces
}

/// The light of the lamps on surfaces: `E = I₀ S e^{−c r} max(n·l, 0) / r²`, 0 at a hole. `normals` are unit vectors in camera
/// axes. If the lighting has an absorption, scattered lamp light is added. Shadows are ignored.
#[must_use]
pub fn irradiance_reference(range: &Plane<f64>, normals: &[Plane<f32>; 3], lighting: &Lighting) -> Rgb<f64> {
    irradiance(range, normals, lighting, None)
}

/// [`irradiance_reference`] with shadows of the lamps on surfaces, traced by `rays`. Scattered lamp light comes from a disc as wide
/// as its kernel at the lamp, and is reduced by the occluded share of that disc.
#[must_use]
pub fn shaded_irradiance_reference(
    range: &Plane<f64>,
    normals: &[Plane<f32>; 3],
    lighting: &Lighting,
    rays: &dyn Rays,
) -> Rgb<f64> {
    irradiance(range, normals, lighting, Some(rays))
}

fn irradiance(
    range: &Plane<f64>,
    normals: &[Plane<f32>; 3],
    lighting: &Lighting,
    rays: Option<&dyn Rays>,
) -> Rgb<f64> {
    Rgb::from_fn(range.width(), range.height(), |x, y| {
        let (ray, z) = (direction(&lighting.camera, x, y), range.pixel(x, y));
        let normal = [0, 1, 2].map(|i| f64::from(normals[i].pixel(x, y)));
        let mut sum = [0.0; 3];
        for lamp in lighting.lamps.iter().filter(|_| !is_hole(z)) {
            let to_lamp = [0, 1, 2].map(|i| lamp.position_m[i] - z * ray[i]);
            let distance = dot(to_lamp, to_lamp).sqrt().max(lighting.radius_m);
            let facing = dot(normal, to_lamp).max(0.0) / distance;
            let cosine = |axis: [f64; 3]| -dot(axis, to_lamp) / distance;
            let profile = lamp.beam.profile(cosine);
            let rays = rays.filter(|_| lamp.shadow != Shadow::None && facing > 0.0);
            let start = rays::leaving(ray.map(|v| v * z), normal);
            let seen = |disc| rays.map_or(1.0, |rays| share_seen(rays, start, lamp.position_m, disc));
            let seen_lamp = seen(lamp.shadow.disc());
            let fall = facing * profile * seen_lamp / (distance * distance);
            let meters = mean(lighting.patches.as_ref(), ray, last(z, distance)) * distance;
            for i in 0..3 {
                let direct = (-lighting.attenuation[i] * meters).exp();
                sum[i] += lamp.intensity[i] * fall * direct;
                let Some(a) = lighting.absorption else { continue };
                let b = lighting.scattering[i];
                let scale = surface_scale(b * meters);
                let spread = multiple::blurred(lamp.beam, scale, cosine);
                let all = (-multiple::surface_depth(a[i], b, meters)).exp();
                let light = spread * (all - direct).max(0.0) * facing / (distance * distance);
                if light != 0.0 {
                    sum[i] += lamp.intensity[i] * light * seen((distance * scale, SPREAD_PLACES));
                }
            }
        }
        sum
    })
}

/// The unit vector along the ray of a pixel.
fn direction(camera: &Intrinsics, x: usize, y: usize) -> [f64; 3] {
    let ray: [f64; 3] = camera.ray(x as f64, y as f64).into();
    let length = dot(ray, ray).sqrt();
    ray.map(|v| v / length)
}
