//! What of the light from above other surfaces hide.
//!
//! The sun is seen from a place where nothing lies on the way to it up to the sea's surface. Of the light from all around, the share
//! of n directions about the normal counts that nothing hides within 10/c of the clearest channel: at the azimuths
//! 2.399963229728653 k and the cosines `sqrt(1 − (k + 1/2)/n)`, each weighted by the radiance Φ from there.

use imaging::Plane;
use imaging::Rgb;
use imaging::rays::{Rays, Ways, leaving, offset};
use imaging::vector::DVec3;

use super::{Daylight, SunLight};
use crate::range::is_hole;

/// The golden angle.
const TURN: f64 = 2.399_963_229_728_653;
/// Attenuation lengths beyond which nothing hides.
const FARTHEST: f64 = 10.0;
/// Pixels are taken by squares of this side: ways that lie beside each other are tested together.
const SQUARE: usize = 8;
/// Of the light from all around every so many pixels have rays of their own.
const STRIDE: usize = 4;
/// Between them it is as between those of one surface: ranges that differ less, and normals at a smaller angle than this cosine.
const ONE_RANGE: f32 = 0.05;
const ONE_NORMAL: f32 = 0.995;
/// Ways that are asked for at once.
const BATCH: usize = 64;

/// Surfaces in camera axes.
#[derive(Clone, Copy)]
pub struct Surfaces<'a> {
    /// Range in meters along the ray.
    pub range: &'a Plane<f32>,
    /// Unit normals that face the camera.
    pub normals: &'a [Plane<f32>; 3],
    /// Which object each pixel shows; none where that is not known.
    pub objects: Option<&'a Plane<u16>>,
}

impl Surfaces<'_> {
    fn normal(&self, x: usize, y: usize) -> [f32; 3] {
        self.normals.each_ref().map(|axis| axis.pixel(x, y))
    }

    fn place(&self, daylight: &Daylight, x: usize, y: usize) -> DVec3 {
        let ray = daylight.gaze.camera.ray(x as f64, y as f64).normalized();
        ray * f64::from(self.range.pixel(x, y))
    }
}

/// How far it is from a place to the surface of the sea along a unit vector that rises by this much.
fn to_sea(daylight: &Daylight, place: DVec3, rise: f64) -> f64 {
    let depth = (daylight.depth - place.dot(daylight.gaze.up.into())).max(0.0);
    if rise > 0.0 { depth / rise } else { f64::INFINITY }
}

fn single(v: DVec3) -> [f32; 3] {
    <[f64; 3]>::from(v).map(|v| v as f32)
}

/// Whether each pixel's surface sees the sun: 1, or 0; 0 also where it turns away from the sun, and at holes.
#[must_use]
pub fn sunlit_reference(
    surfaces: Surfaces<'_>,
    daylight: &Daylight,
    sun: &SunLight,
    rays: &dyn Rays,
) -> Plane<f32> {
    let toward = sun.toward(&daylight.gaze);
    Plane::from_fn(surfaces.range.width(), surfaces.range.height(), |x, y| {
        let normal = surfaces.normal(x, y).map(f64::from);
        if is_hole(surfaces.range.pixel(x, y)) || DVec3::from(normal).dot(toward.into()) <= 0.0 {
            return 0.0;
        }
        let place = surfaces.place(daylight, x, y);
        let meters = to_sea(daylight, place, sun.rise);
        let start = leaving(place.into(), normal);
        let is_seen = meters <= start.from || !rays.occluded(start.origin, toward, start.from, meters);
        f32::from(u8::from(is_seen))
    })
}

/// [`sunlit_reference`] with many rays at once.
#[must_use]
pub fn sunlit(surfaces: Surfaces<'_>, daylight: &Daylight, sun: &SunLight, rays: &dyn Rays) -> Plane<f32> {
    let (width, height) = surfaces.range.size();
    let toward = DVec3::from(sun.toward(&daylight.gaze));
    let mut lit = Plane::filled(width, height, 0.0f32);
    let (mut ways, mut pixels, mut clear) = (Ways::default(), Vec::new(), Vec::new());
    for top in (0..height).step_by(SQUARE) {
        ways.clear();
        pixels.clear();
        for left in (0..width).step_by(SQUARE) {
            for y in top..(top + SQUARE).min(height) {
                for x in left..(left + SQUARE).min(width) {
                    let normal = DVec3::from(surfaces.normal(x, y).map(f64::from));
                    if is_hole(surfaces.range.pixel(x, y)) || normal.dot(toward) <= 0.0 {
                        continue;
                    }
                    let place = surfaces.place(daylight, x, y);
                    let start = place + normal * offset(place.into());
                    let end = start + toward * to_sea(daylight, place, sun.rise);
                    ways.push(single(start), single(end));
                    pixels.push(y * width + x);
                }
            }
        }
        clear.clear();
        clear.resize(ways.len(), false);
        rays.look(&ways, &mut clear);
        for (&pixel, &clear) in pixels.iter().zip(&clear) {
            lit.data_mut()[pixel] = if clear { 1.0 } else { 0.0 };
        }
    }
    lit
}

/// The directions about a normal.
struct Directions {
    /// Cosine from the normal, and both parts across it.
    parts: Vec<[f64; 3]>,
}

impl Directions {
    fn new(count: usize) -> Self {
        let part = |k: usize| {
            let cosine = (1.0 - (k as f64 + 0.5) / count as f64).sqrt();
            let across = (1.0 - cosine * cosine).sqrt();
            let (sine, turned) = (TURN * k as f64).sin_cos();
            [cosine, across * turned, across * sine]
        };
        Self {
            parts: (0..count).map(part).collect(),
        }
    }

    /// Direction k about a unit vector, in the frame of Duff et al. (2017).
    fn about(&self, k: usize, normal: DVec3) -> DVec3 {
        let DVec3 { x, y, z } = normal;
        let sign = if z >= 0.0 { 1.0 } else { -1.0 };
        let a = -1.0 / (sign + z);
        let b = x * y * a;
        let first = DVec3::from([1.0 + sign * x * x * a, sign * b, -sign * x]);
        let second = DVec3::from([b, sign + y * y * a, -y]);
        let [ahead, along, aside] = self.parts[k];
        normal * ahead + first * along + second * aside
    }
}

/// What a place needs to know of its surroundings.
struct Sky<'a> {
    daylight: &'a Daylight,
    directions: Directions,
    /// m.
    farthest: f64,
}

impl<'a> Sky<'a> {
    fn new(daylight: &'a Daylight, attenuation: [f64; 3]) -> Self {
        let clearest = attenuation.into_iter().fold(f64::INFINITY, f64::min);
        Self {
            daylight,
            directions: Directions::new(daylight.rays),
            farthest: FARTHEST / clearest.max(1e-6),
        }
    }

    fn count(&self) -> usize {
        self.daylight.rays
    }

    fn way(&self, place: DVec3, direction: DVec3) -> f64 {
        let rise = direction.dot(self.daylight.gaze.up.into());
        self.farthest.min(to_sea(self.daylight, place, rise))
    }

    /// A of each channel where these directions are clear.
    fn access(&self, normal: DVec3, clear: impl Fn(usize) -> bool) -> [f32; 3] {
        let (mut open, mut all) = ([0.0; 3], [0.0; 3]);
        for k in 0..self.count() {
            let rise = self.directions.about(k, normal).dot(self.daylight.gaze.up.into());
            let is_clear = clear(k);
            for c in 0..3 {
                let light = self.daylight.fields[c].shape.phi(rise);
                all[c] += light;
                open[c] += if is_clear { light } else { 0.0 };
            }
        }
        [0, 1, 2].map(|c| (open[c] / all[c]) as f32)
    }
}

/// A of every pixel; 1 at holes. `attenuation` is c of each channel.
#[must_use]
pub fn access_reference(
    surfaces: Surfaces<'_>,
    daylight: &Daylight,
    attenuation: [f64; 3],
    rays: &dyn Rays,
) -> Rgb<f32> {
    let sky = Sky::new(daylight, attenuation);
    Rgb::from_fn(surfaces.range.width(), surfaces.range.height(), |x, y| {
        if is_hole(surfaces.range.pixel(x, y)) {
            return [1.0; 3];
        }
        let normal = DVec3::from(surfaces.normal(x, y).map(f64::from));
        let place = surfaces.place(daylight, x, y);
        let start = leaving(place.into(), normal.into());
        sky.access(normal, |k| {
            let direction = sky.directions.about(k, normal);
            let meters = sky.way(place, direction);
            meters <= start.from || !rays.occluded(start.origin, direction.into(), start.from, meters)
        })
    })
}

/// [`access_reference`] with many rays at once, at every fourth pixel of every fourth row; pixels between four of one surface lie
/// between their values, all others have rays of their own.
#[must_use]
pub fn access(
    surfaces: Surfaces<'_>,
    daylight: &Daylight,
    attenuation: [f64; 3],
    rays: &dyn Rays,
) -> Rgb<f32> {
    let (width, height) = surfaces.range.size();
    let sky = Sky::new(daylight, attenuation);
    let (columns, rows) = (knots(width), knots(height));
    let places: Vec<[usize; 2]> = rows
        .iter()
        .flat_map(|&y| columns.iter().map(move |&x| [x, y]))
        .collect();
    let coarse = at_places(surfaces, &sky, rays, &places);
    let mut open =
        Rgb::new([(); 3].map(|()| Plane::filled(width, height, 1.0f32))).expect("planes of one size");
    let mut rest = Vec::new();
    for y in 0..height {
        let j = (y / STRIDE).min(rows.len().saturating_sub(2));
        for x in 0..width {
            if is_hole(surfaces.range.pixel(x, y)) {
                continue;
            }
            let i = (x / STRIDE).min(columns.len().saturating_sub(2));
            let next = |at: usize, of: &[usize]| (at + 1).min(of.len() - 1);
            let corners = [
                (i, j),
                (next(i, &columns), j),
                (i, next(j, &rows)),
                (next(i, &columns), next(j, &rows)),
            ];
            if !corners
                .iter()
                .all(|&(i, j)| is_one(surfaces, [x, y], [columns[i], rows[j]]))
            {
                rest.push([x, y]);
                continue;
            }
            let share = |at: usize, low: usize, high: usize| {
                if high == low {
                    0.0
                } else {
                    (at - low) as f32 / (high - low) as f32
                }
            };
            let s = share(x, columns[i], columns[next(i, &columns)]);
            let t = share(y, rows[j], rows[next(j, &rows)]);
            let [a, b, c, d] = corners.map(|(i, j)| coarse[j * columns.len() + i]);
            for (band, plane) in open.planes_mut().into_iter().enumerate() {
                let above = a[band] * (1.0 - s) + b[band] * s;
                let below = c[band] * (1.0 - s) + d[band] * s;
                plane[y * width + x] = above * (1.0 - t) + below * t;
            }
        }
    }
    rest.sort_by_key(|&[x, y]| (y / SQUARE, x / SQUARE));
    for (&[x, y], value) in rest.iter().zip(at_places(surfaces, &sky, rays, &rest)) {
        for (plane, value) in open.planes_mut().into_iter().zip(value) {
            plane[y * width + x] = value;
        }
    }
    open
}

/// Every so many of so many places, and the last.
fn knots(count: usize) -> Vec<usize> {
    let mut knots: Vec<usize> = (0..count).step_by(STRIDE).collect();
    if knots.last() != Some(&(count - 1)) {
        knots.push(count - 1);
    }
    knots
}

/// Whether two pixels show one surface.
fn is_one(surfaces: Surfaces<'_>, [x, y]: [usize; 2], [i, j]: [usize; 2]) -> bool {
    let (own, other) = (surfaces.range.pixel(x, y), surfaces.range.pixel(i, j));
    let (n, m) = (surfaces.normal(x, y), surfaces.normal(i, j));
    let turned = n[0] * m[0] + n[1] * m[1] + n[2] * m[2];
    let object = surfaces
        .objects
        .is_none_or(|objects| objects.pixel(x, y) == objects.pixel(i, j));
    object && (own - other).abs() < ONE_RANGE * own && turned > ONE_NORMAL
}

/// A at some pixels that are near each other in the list; 1 at holes.
fn at_places(surfaces: Surfaces<'_>, sky: &Sky<'_>, rays: &dyn Rays, places: &[[usize; 2]]) -> Vec<[f32; 3]> {
    let mut values = Vec::with_capacity(places.len());
    let (mut ways, mut clear) = (Ways::default(), Vec::new());
    for batch in places.chunks(BATCH) {
        let starts: Vec<(DVec3, DVec3)> = batch
            .iter()
            .map(|&[x, y]| {
                let normal = DVec3::from(surfaces.normal(x, y).map(f64::from));
                if is_hole(surfaces.range.pixel(x, y)) {
                    return (DVec3::from([0.0; 3]), DVec3::from([0.0, 0.0, -1.0]));
                }
                (surfaces.place(sky.daylight, x, y), normal)
            })
            .collect();
        ways.clear();
        for k in 0..sky.count() {
            for &(place, normal) in &starts {
                let direction = sky.directions.about(k, normal);
                let start = place + normal * offset(place.into());
                ways.push(
                    single(start),
                    single(start + direction * sky.way(place, direction)),
                );
            }
        }
        clear.clear();
        clear.resize(ways.len(), false);
        rays.look(&ways, &mut clear);
        for (i, (&[x, y], &(_, normal))) in batch.iter().zip(&starts).enumerate() {
            let is_open = is_hole(surfaces.range.pixel(x, y));
            let value = sky.access(normal, |k| clear[k * batch.len() + i]);
            values.push(if is_open { [1.0; 3] } else { value });
        }
    }
    values
}

#[cfg(test)]
mod tests;
