//! Occlusion of the veil: the share of daylight that reaches the water in front of surfaces.
//!
//! Daylight is scattered toward the camera along the whole line of sight. Next to walls and under structures a part of it is occluded.
//! At places of each ray, equal in `1 − e^{−c t}`, shadow rays are traced in directions ω spread evenly over the sphere, weighted by the
//! radiance Φ from there and by the Henyey–Greenstein function of its angle to the line of sight v:
//!
//! ```text
//! V = Σ Φ(μ_ω) p(ω·v) s(ω) / Σ Φ(μ_ω) p(ω·v)
//! ```
//!
//! s is 1 in a direction without occluder within 1.5 attenuation lengths, else the light of the water before it, whose distance is taken
//! as even in that length: `1 − (1 − e^{−1.5})/1.5`. The sun is occluded by one ray of its own.

use imaging::rays::{Rays, Ways};
use imaging::vector::{DVec3, vec3};
use imaging::{Plane, Rgb, vectorized};

use super::super::Daylight;
use super::{single, to_sea};
use crate::range::is_hole;

/// Places along each line of sight.
const PLACES: usize = 3;
/// Directions from each place.
const DIRECTIONS: usize = 16;
/// Every so many pixels has a line of sight of its own: the veil is smooth.
const STRIDE: usize = 16;
/// Attenuation lengths within which occluders count.
const REACH: f64 = 1.5;
/// Light of the water before an occluder: the mean of `1 − e^{−x}` over 0..1.5.
const BEFORE_OCCLUDER: f64 = 0.482;
/// Mean cosine of the scattering that turns daylight into the veil. The forward peak of the phase function carries light of surfaces,
/// which forward scatter computes.
const ASYMMETRY: f64 = 0.5;
/// Attenuation lengths of a line of sight that meets no surface.
const FARTHEST: f64 = 8.0;
/// The golden angle.
const TURN: f64 = 2.399_963_229_728_653;

/// The share of the veil that remains at every pixel. `attenuation` is c of the clearest channel.
#[must_use]
pub fn veil_access(range: &Plane<f32>, daylight: &Daylight, attenuation: f64, rays: &dyn Rays) -> Plane<f32> {
    let veil = OccludedVeil::new(daylight, attenuation);
    let (width, height) = range.size();
    let (columns, rows) = (width.div_ceil(STRIDE) + 1, height.div_ceil(STRIDE) + 1);
    let mut ways = Ways::default();
    let mut clear = Vec::new();
    let mut coarse = Plane::filled(columns, rows, 1.0f32);
    for row in 0..rows {
        ways.clear();
        let pixel = |column: usize| ((column * STRIDE).min(width - 1), (row * STRIDE).min(height - 1));
        for column in 0..columns {
            let (x, y) = pixel(column);
            for place in veil.places(range, x, y) {
                for direction in veil.directions() {
                    let end = place + direction * veil.reach(place, direction);
                    ways.push(single(place), single(end));
                }
            }
        }
        clear.clear();
        clear.resize(ways.len(), true);
        rays.look(&ways, &mut clear);
        let of_pixel = PLACES * veil.ways_per_place();
        for (column, clear) in clear.chunks(of_pixel).enumerate() {
            let (x, y) = pixel(column);
            coarse.row_mut(row)[column] = veil.share(x, y, |k| clear[k]) as f32;
        }
    }
    Plane::from_fn(width, height, |x, y| between(&coarse, x, y))
}

/// [`veil_access`] at every pixel, one ray after the other.
#[must_use]
pub fn veil_access_reference(
    range: &Plane<f32>,
    daylight: &Daylight,
    attenuation: f64,
    rays: &dyn Rays,
) -> Plane<f32> {
    let veil = OccludedVeil::new(daylight, attenuation);
    Plane::from_fn(range.width(), range.height(), |x, y| {
        let clear: Vec<bool> = veil
            .places(range, x, y)
            .into_iter()
            .flat_map(|place| {
                let directions = veil.directions();
                directions.map(move |direction| (place, direction))
            })
            .map(|(place, direction)| {
                let meters = veil.reach(place, direction);
                !rays.occluded(place.into(), direction.into(), 0.0, meters)
            })
            .collect();
        veil.share(x, y, |k| clear[k]) as f32
    })
}

/// Multiplies the veil by what remains of it, and adds the change to the light.
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

/// Interpolates linearly between the lines of sight of a coarse grid.
fn between(coarse: &Plane<f32>, x: usize, y: usize) -> f32 {
    let (column, row) = (x / STRIDE, y / STRIDE);
    let [right, down] = [x, y].map(|v| (v % STRIDE) as f32 / STRIDE as f32);
    let mix = |row: usize| {
        let [left, next] = [column, column + 1].map(|column| coarse.pixel(column, row));
        left + (next - left) * right
    };
    let [above, below] = [mix(row), mix(row + 1)];
    above + (below - above) * down
}

/// The geometry and the weights of an occluded veil.
struct OccludedVeil<'a> {
    daylight: &'a Daylight,
    attenuation: f64,
    up: DVec3,
    directions: Vec<DVec3>,
    /// Toward the sun, and its share at the camera.
    sun: Option<(DVec3, f64)>,
}

impl<'a> OccludedVeil<'a> {
    fn new(daylight: &'a Daylight, attenuation: f64) -> Self {
        let direction = |k: usize| {
            let rise = 1.0 - (2.0 * k as f64 + 1.0) / DIRECTIONS as f64;
            let level = (1.0 - rise * rise).sqrt();
            let (sine, cosine) = (TURN * k as f64).sin_cos();
            vec3(level * cosine, rise, level * sine)
        };
        let shares = |sun: &super::super::SunLight| {
            let shares = daylight
                .fields
                .each_ref()
                .map(|field| sun.share_at(field, daylight.depth));
            (shares[0] + shares[1] + shares[2]) / 3.0
        };
        Self {
            daylight,
            attenuation: attenuation.max(1e-6),
            up: daylight.gaze.up.into(),
            directions: (0..DIRECTIONS).map(direction).collect(),
            sun: daylight
                .sun
                .as_ref()
                .map(|sun| (sun.toward(&daylight.gaze).into(), shares(sun))),
        }
    }

    fn ways_per_place(&self) -> usize {
        DIRECTIONS + usize::from(self.sun.is_some())
    }

    fn directions(&self) -> impl Iterator<Item = DVec3> + '_ {
        let sun = self.sun.map(|(direction, _)| direction);
        self.directions.iter().copied().chain(sun)
    }

    /// Length of a shadow ray: to the sea surface, and of those to the sky no farther than [`REACH`].
    fn reach(&self, place: DVec3, direction: DVec3) -> f64 {
        let surface = to_sea(self.daylight, place, direction.dot(self.up));
        let is_sun = self.sun.is_some_and(|(sun, _)| sun == direction);
        let reach = if is_sun { FARTHEST } else { REACH };
        surface.min(reach / self.attenuation)
    }

    /// Places of a line of sight, equal in `1 − e^{−c t}`.
    fn places(&self, range: &Plane<f32>, x: usize, y: usize) -> [DVec3; PLACES] {
        let ray = self.daylight.gaze.camera.ray(x as f64, y as f64).normalized();
        let z = range.pixel(x, y);
        let rise = ray.dot(self.up);
        let open = FARTHEST / self.attenuation;
        let end = if is_hole(z) { open } else { f64::from(z) };
        let end = end.min(to_sea(self.daylight, vec3(0.0, 0.0, 0.0), rise));
        let lost = -(-self.attenuation * end).exp_m1();
        std::array::from_fn(|k| {
            let share = (k as f64 + 0.5) / PLACES as f64;
            ray * (-(-share * lost).ln_1p() / self.attenuation)
        })
    }

    /// V of a pixel whose shadow rays are clear or not, in the order of its places and their directions.
    fn share(&self, x: usize, y: usize, clear: impl Fn(usize) -> bool) -> f64 {
        let sight = self.daylight.gaze.camera.ray(x as f64, y as f64).normalized();
        // The shape of green stands for all: channels differ less than directions.
        let shape = &self.daylight.fields[1].shape;
        let weight = |direction: &DVec3| {
            let cosine = sight.dot(*direction);
            let spread = 1.0 + ASYMMETRY * ASYMMETRY - 2.0 * ASYMMETRY * cosine;
            shape.phi(direction.dot(self.up)) / spread.powf(1.5)
        };
        let weights: Vec<f64> = self.directions.iter().map(weight).collect();
        let all: f64 = weights.iter().sum();
        let per_place = self.ways_per_place();
        let of_place = |place: usize| {
            let first = place * per_place;
            let open = weights
                .iter()
                .enumerate()
                .map(|(k, weight)| weight * if clear(first + k) { 1.0 } else { BEFORE_OCCLUDER });
            let sky = open.sum::<f64>() / all;
            match self.sun {
                Some((_, share)) => {
                    let sun = if clear(first + DIRECTIONS) { 1.0 } else { 0.0 };
                    share * sun + (1.0 - share) * sky
                }
                None => sky,
            }
        };
        (0..PLACES).map(of_place).sum::<f64>() / PLACES as f64
    }
}
