//! Occlusion of the veil: the share of daylight that reaches the water in front of surfaces.
//!
//! Daylight is scattered toward the camera along the whole line of sight. Next to walls and under structures a part of it is
//! occluded. At points of each ray, equally spaced in `1 − e^{−c t}`, shadow rays are traced in directions ω spread evenly over the
//! sphere, weighted by the radiance L from there and by the phase function p without its forward peak:
//!
//! ```text
//! V = Σ L(μ_ω) p(ω·v) s(ω) / Σ L(μ_ω) p(ω·v)
//! ```
//!
//! s is 1 in a direction without occluder. Before an occluder at the distance d, the water sends the share `1 − e^{−c d}`, which is the
//! probability that a length drawn from `e^{−c t}` is shorter than d. The shadow rays have three such lengths in turn. c = a + w b is the
//! attenuation of the veil in the clearest channel, without the forward peak. The sun has separate shadow rays from more points: each
//! is either lit or in shadow, and few points would leave steps in the veil.

use std::array::from_fn;

use imaging::rays::{Rays, ShadowRays};
use imaging::vector::{DVec3, vec3};
use imaging::{Plane, Rgb, vectorized};

use super::veil_grid::Grid;
use super::{single, to_sea};
use crate::daylight::conditions::Daylight;
use crate::range::is_hole;

/// Points along each line of sight with shadow rays all around.
const PLACES: usize = 3;
/// Directions from each of them.
const DIRECTIONS: usize = 16;
/// Points along each line of sight with a shadow ray toward the sun.
const SUN_PLACES: usize = 12;
/// Attenuation lengths of the shadow rays all around, `−ln(1 − (k + 1/2)/3)`.
const REACHES: [f64; PLACES] = [0.182_321_557, std::f64::consts::LN_2, 1.791_759_469];
/// Attenuation lengths of a line of sight without a surface.
const FARTHEST: f64 = 8.0;
/// The golden angle.
const TURN: f64 = 2.399_963_229_728_653;
/// Lines of sight in one batch.
const BATCH: usize = 64;

/// The share of the veil that remains at every pixel. Interpolates between lines of sight of
/// coarse grids where these agree, see [`Grid`].
#[must_use]
pub fn veil_access(range: &Plane<f32>, daylight: &Daylight, rays: &dyn Rays) -> Plane<f32> {
    let veil = OccludedVeil::new(daylight);
    let lost = range.map(|&z| veil.lost(veil.length(z)) as f32);
    let mut access = Plane::filled(range.width(), range.height(), f32::NAN);
    let mut grid = Some(Grid::coarsest(range.size()));
    while let Some(current) = grid {
        let pixels = current.needed(&access);
        let traced = veil.trace(range, &pixels, rays);
        current.interpolate(&pixels, &traced, &lost, &mut access);
        grid = current.finer();
    }
    access
}

/// [`veil_access`] at every pixel, one ray after the other.
#[must_use]
pub fn veil_access_reference(range: &Plane<f32>, daylight: &Daylight, rays: &dyn Rays) -> Plane<f32> {
    let veil = OccludedVeil::new(daylight);
    Plane::from_fn(range.width(), range.height(), |x, y| {
        let line = veil.line(range, [x, y]);
        let is_clear = |k: usize| {
            let ShadowRay {
                from,
                direction,
                meters,
            } = veil.shadow_ray(&line, k);
            !rays.occluded(from.into(), direction.into(), 0.0, meters)
        };
        veil.share(&line, is_clear) as f32
    })
}

/// Multiplies the veil by its visible share, and adds the change to the light.
pub fn occlude_veil(veil: &mut Rgb<f32>, light: &mut Rgb<f32>, access: &Plane<f32>) {
    for (veil, light) in veil.planes_mut().into_iter().zip(light.planes_mut()) {
        vectorized!(change(veil, light, access.data()));
    }
}

#[inline(always)]
fn change(veil: &mut [f32], light: &mut [f32], access: &[f32]) {
    for ((veil, light), &share) in veil.iter_mut().zip(light).zip(access) {
        let change = *veil * (share - 1.0);
        *veil += change;
        *light += change;
    }
}

/// A line of sight from the camera.
struct Line {
    /// Unit vector.
    direction: DVec3,
    /// The share of singly scattered sunlight in its veil.
    sun_share: f64,
    /// Distances of the points with shadow rays all around, m.
    places: [f64; PLACES],
    /// Distances of those with a ray toward the sun, m.
    sun_places: [f64; SUN_PLACES],
}

/// A ray from a point of a line of sight.
struct ShadowRay {
    from: DVec3,
    /// Unit vector.
    direction: DVec3,
    meters: f64,
}

/// The geometry and the weights of an occluded veil.
struct OccludedVeil<'a> {
    daylight: &'a Daylight,
    /// c = a + w b of the clearest channel, per length of the range.
    attenuation: f64,
    up: DVec3,
    directions: [DVec3; DIRECTIONS],
    /// Radiance from each of them. Green stands for all: channels differ less than directions.
    radiances: [f64; DIRECTIONS],
    /// Toward the sun.
    sun: Option<DVec3>,
}

impl<'a> OccludedVeil<'a> {
    fn new(daylight: &'a Daylight) -> Self {
        let attenuations = daylight.fields.each_ref().map(|field| field.attenuation);
        let clearest = attenuations.into_iter().fold(f64::INFINITY, f64::min);
        let direction = |k: usize| {
            let rise = 1.0 - (2.0 * k as f64 + 1.0) / DIRECTIONS as f64;
            let level = (1.0 - rise * rise).sqrt();
            let (sine, cosine) = (TURN * k as f64).sin_cos();
            vec3(level * cosine, rise, level * sine)
        };
        let up = DVec3::from(daylight.gaze.up);
        let directions: [DVec3; DIRECTIONS] = from_fn(direction);
        Self {
            daylight,
            attenuation: clearest.max(1e-6),
            up,
            directions,
            radiances: directions.map(|direction| daylight.fields[1].around.value(direction.dot(up)).exp()),
            sun: daylight.sun.map(|sun| sun.toward(&daylight.gaze).into()),
        }
    }

    /// Shadow rays of each line of sight.
    fn rays_per_line(&self) -> usize {
        PLACES * DIRECTIONS + self.sun.map_or(0, |_| SUN_PLACES)
    }

    /// Length of a line of sight to a surface, without the sea surface.
    fn length(&self, z: f32) -> f64 {
        if is_hole(z) {
            FARTHEST / self.attenuation
        } else {
            f64::from(z)
        }
    }

    /// `1 − e^{−c t}`.
    fn lost(&self, meters: f64) -> f64 {
        -(-self.attenuation * meters).exp_m1()
    }

    fn line(&self, range: &Plane<f32>, [x, y]: [usize; 2]) -> Line {
        let direction = self.daylight.gaze.camera.ray(x as f64, y as f64).normalized();
        let sea = to_sea(self.daylight, vec3(0.0, 0.0, 0.0), direction.dot(self.up));
        let end = self.length(range.pixel(x, y)).min(sea);
        let lost = self.lost(end);
        let meters = |k: usize, count: usize| {
            let share = (k as f64 + 0.5) / count as f64;
            -(-share * lost).ln_1p() / self.attenuation
        };
        Line {
            direction,
            places: from_fn(|k| meters(k, PLACES)),
            sun_places: from_fn(|k| {
                if self.sun.is_some() {
                    meters(k, SUN_PLACES)
                } else {
                    0.0
                }
            }),
            sun_share: if self.sun.is_some() {
                self.daylight.sun_share_of_veil(direction.into(), end)
            } else {
                0.0
            },
        }
    }

    /// Shadow ray `k` of a line of sight: [`DIRECTIONS`] from each of its [`PLACES`], then those toward the sun. Each ends at the sea
    /// surface, and those not toward the sun after one of the [`REACHES`]: each place and each direction has all of them.
    fn shadow_ray(&self, line: &Line, k: usize) -> ShadowRay {
        let (meters, direction, reach) = match self.sun {
            Some(sun) if k >= PLACES * DIRECTIONS => {
                (line.sun_places[k - PLACES * DIRECTIONS], sun, FARTHEST)
            }
            _ => {
                let (place, direction) = (k / DIRECTIONS, k % DIRECTIONS);
                let reach = REACHES[(place + direction) % PLACES];
                (line.places[place], self.directions[direction], reach)
            }
        };
        let start = line.direction * meters;
        let surface = to_sea(self.daylight, start, direction.dot(self.up));
        ShadowRay {
            from: start,
            direction,
            meters: surface.min(reach / self.attenuation),
        }
    }

    /// V of these pixels in ray packets; rays of one kind of neighboring pixels are adjacent.
    fn trace(&self, range: &Plane<f32>, pixels: &[[usize; 2]], rays: &dyn Rays) -> Vec<f32> {
        let mut values = Vec::with_capacity(pixels.len());
        let (mut ways, mut clear) = (ShadowRays::default(), Vec::new());
        for batch in pixels.chunks(BATCH) {
            let lines: Vec<Line> = batch.iter().map(|&pixel| self.line(range, pixel)).collect();
            ways.clear();
            for k in 0..self.rays_per_line() {
                for line in &lines {
                    let ShadowRay {
                        from,
                        direction,
                        meters,
                    } = self.shadow_ray(line, k);
                    ways.push(single(from), single(from + direction * meters));
                }
            }
            clear.clear();
            clear.resize(ways.len(), true);
            rays.trace_shadow_rays(&ways, &mut clear);
            let shares = lines
                .iter()
                .enumerate()
                .map(|(i, line)| self.share(line, |k| clear[k * lines.len() + i]) as f32);
            values.extend(shares);
        }
        values
    }

    /// V of a line of sight whose shadow rays are clear or not.
    fn share(&self, line: &Line, is_clear: impl Fn(usize) -> bool) -> f64 {
        let (mut open, mut all) = (0.0, 0.0);
        for (k, direction) in self.directions.iter().enumerate() {
            let weight = self.radiances[k] * self.daylight.wide.density(line.direction.dot(*direction));
            let clear = (0..PLACES)
                .filter(|place| is_clear(place * DIRECTIONS + k))
                .count() as f64;
            all += weight;
            open += weight * clear / PLACES as f64;
        }
        let sky = open / all;
        self.sun.map_or(sky, |_| {
            let share = line.sun_share;
            let first = PLACES * DIRECTIONS;
            let clear = (first..first + SUN_PLACES).filter(|&k| is_clear(k)).count() as f64;
            share * clear / SUN_PLACES as f64 + (1.0 - share) * sky
        })
    }
}
