//! Ambient occlusion of daylight.

use imaging::rays::{Rays, ShadowRays, leaving, offset};
use imaging::vector::DVec3;
use imaging::{Plane, Rgb, vectorized};

use super::super::field::SOURCE_TERMS;
use super::directions::{Directions, across};
use super::ordered::trace_by_direction;
use super::{SQUARE, Surfaces, single, to_sea};
use crate::attenuation::exp_negative;
use crate::daylight::conditions::Daylight;
use crate::polynomial::horner;
use crate::range::is_hole;

/// Occluders beyond this number of attenuation lengths are ignored.
const FARTHEST: f64 = 10.0;
/// Pixels from one ray origin to the next.
const STRIDE: usize = 4;
/// Between them it is as between those of one surface: ranges that differ less, and normals at a smaller angle than this cosine.
const ONE_RANGE: f32 = 0.05;
const ONE_NORMAL: f32 = 0.995;
/// Ray origins in one batch, and in a group whose rays are traced together.
const BATCH: usize = 64;
const GROUP: usize = 16 * BATCH;
/// Side of the blocks of pixels that fill a group.
const BLOCK: usize = 4 * SQUARE;

/// Surroundings of a ray origin.
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
                let light = self.daylight.fields[c].around.value(rise).exp();
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

/// [`access_reference`] in ray packets, at every fourth pixel of every fourth row. Other pixels are interpolated between those of
/// the four around them that show the same surface; without such a neighbor, a pixel has its exact rays.
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
    let coarse = at_knots(surfaces, &sky, rays, (&columns, &rows));
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
            let (right, below) = ((i + 1).min(columns.len() - 1), (j + 1).min(rows.len() - 1));
            let [s, t] = [
                share(x, columns[i], columns[right]),
                share(y, rows[j], rows[below]),
            ];
            let corners = [
                (i, j, (1.0 - s) * (1.0 - t)),
                (right, j, s * (1.0 - t)),
                (i, below, (1.0 - s) * t),
                (right, below, s * t),
            ];
            let (mut sum, mut weight) = ([0.0f32; 3], 0.0);
            for (i, j, near) in corners {
                if near > 0.0 && is_one(surfaces, [x, y], [columns[i], rows[j]]) {
                    weight += near;
                    let own = coarse[j * columns.len() + i];
                    (0..3).for_each(|c| sum[c] += near * own[c]);
                }
            }
            if weight == 0.0 {
                rest.push([x, y]);
                continue;
            }
            for (plane, sum) in open.planes_mut().into_iter().zip(sum) {
                plane[y * width + x] = sum / weight;
            }
        }
    }
    rest.sort_by_key(|&place| block_of(place));
    for (&[x, y], value) in rest.iter().zip(at_places(surfaces, &sky, rays, &rest)) {
        for (plane, value) in open.planes_mut().into_iter().zip(value) {
            plane[y * width + x] = value;
        }
    }
    open
}

/// Order of places: by block, and by square within it.
fn block_of([x, y]: [usize; 2]) -> [usize; 4] {
    [y / BLOCK, x / BLOCK, y / SQUARE, x / SQUARE]
}

/// Where between two knots a pixel is.
fn share(at: usize, low: usize, high: usize) -> f32 {
    if high == low {
        0.0
    } else {
        (at - low) as f32 / (high - low) as f32
    }
}

/// A at the knots, row by row.
fn at_knots(
    surfaces: Surfaces<'_>,
    sky: &Sky<'_>,
    rays: &dyn Rays,
    (columns, rows): (&[usize], &[usize]),
) -> Vec<[f32; 3]> {
    let mut order: Vec<[usize; 2]> = (0..rows.len())
        .flat_map(|j| (0..columns.len()).map(move |i| [i, j]))
        .filter(|&[i, j]| !is_hole(surfaces.range.pixel(columns[i], rows[j])))
        .collect();
    order.sort_by_key(|&place| block_of(place));
    let places: Vec<[usize; 2]> = order.iter().map(|&[i, j]| [columns[i], rows[j]]).collect();
    let mut values = vec![[1.0; 3]; rows.len() * columns.len()];
    for ([i, j], value) in order.iter().zip(at_places(surfaces, sky, rays, &places)) {
        values[j * columns.len() + i] = value;
    }
    values
}

/// Every `STRIDE`-th index, and the last.
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

/// A at some pixels with surfaces that are near each other in the list.
fn at_places(surfaces: Surfaces<'_>, sky: &Sky<'_>, rays: &dyn Rays, places: &[[usize; 2]]) -> Vec<[f32; 3]> {
    let mut values = Vec::with_capacity(places.len());
    let (mut ways, mut clear, mut bundles) = (ShadowRays::default(), Vec::new(), Vec::new());
    let gaze = Gaze::new(sky);
    for group in places.chunks(GROUP) {
        ways.clear();
        bundles.clear();
        for batch in group.chunks(BATCH) {
            let spots = Spots::new(surfaces, sky.daylight, batch);
            for part in &sky.directions.parts {
                let mut bundle = Bundle::default();
                let part = part.map(|v| v as f32);
                vectorized!(spread(&spots, gaze, part, &mut bundle));
                let axes = ways.from.iter_mut().chain(&mut ways.to);
                for (axis, lane) in axes.zip(spots.from.iter().chain(&bundle.to)) {
                    axis.extend_from_slice(&lane[..batch.len()]);
                }
                bundles.push(bundle);
            }
        }
        trace_by_direction(rays, &ways, &mut clear);
        let batches = group.chunks(BATCH).zip(bundles.chunks(sky.count()));
        let mut clear = clear.as_slice();
        for (batch, bundles) in batches {
            let (own, rest) = clear.split_at(batch.len() * bundles.len());
            values.extend((0..batch.len()).map(|i| weigh(bundles, own, (i, batch.len()))));
            clear = rest;
        }
    }
    values
}

/// A of place `i` of `count`, from its light in each direction and whether its rays are clear, direction by direction.
fn weigh(bundles: &[Bundle], clear: &[bool], (i, count): (usize, usize)) -> [f32; 3] {
    let (mut open, mut all) = ([0.0f32; 3], [0.0f32; 3]);
    for (k, bundle) in bundles.iter().enumerate() {
        let is_clear = clear[k * count + i];
        for c in 0..3 {
            let light = bundle.light[c][i];
            all[c] += light;
            open[c] += if is_clear { light } else { 0.0 };
        }
    }
    [0, 1, 2].map(|c| open[c] / all[c])
}

type Lane = [f32; BATCH];

/// Ray origins, offset from their surfaces, with the normals and the axes across them.
struct Spots {
    from: [Lane; 3],
    normal: [Lane; 3],
    first: [Lane; 3],
    second: [Lane; 3],
}

impl Spots {
    fn new(surfaces: Surfaces<'_>, daylight: &Daylight, places: &[[usize; 2]]) -> Self {
        let blank = || [[0.0f32; BATCH]; 3];
        let mut spots = Self {
            from: blank(),
            normal: blank(),
            first: blank(),
            second: blank(),
        };
        for (i, &[x, y]) in places.iter().enumerate() {
            let normal = DVec3::from(surfaces.normal(x, y).map(f64::from));
            let place = surfaces.place(daylight, x, y);
            let [first, second] = across(normal);
            let start = place + normal * offset(place.into());
            let lanes = [
                &mut spots.from,
                &mut spots.normal,
                &mut spots.first,
                &mut spots.second,
            ];
            for (lanes, vector) in lanes.into_iter().zip([start, normal, first, second]) {
                for (lane, v) in lanes.iter_mut().zip(single(vector)) {
                    lane[i] = v;
                }
            }
        }
        spots
    }
}

/// A packet of rays in one direction about some normals, and the light from there in each channel.
#[derive(Clone)]
struct Bundle {
    to: [Lane; 3],
    light: [Lane; 3],
}

impl Default for Bundle {
    fn default() -> Self {
        Self {
            to: [[0.0; BATCH]; 3],
            light: [[0.0; BATCH]; 3],
        }
    }
}

/// The vertical and the light by direction in f32.
#[derive(Clone, Copy)]
struct Gaze {
    up: [f32; 3],
    depth: f32,
    farthest: f32,
    around: [[f32; SOURCE_TERMS]; 3],
}

impl Gaze {
    fn new(sky: &Sky<'_>) -> Self {
        let fields = &sky.daylight.fields;
        Self {
            up: sky.daylight.gaze.up.map(|v| v as f32),
            depth: sky.daylight.depth as f32,
            farthest: sky.farthest as f32,
            around: [0, 1, 2].map(|c| fields[c].around.single()),
        }
    }
}

#[inline(always)]
fn spread(spots: &Spots, gaze: Gaze, [ahead, along, aside]: [f32; 3], bundle: &mut Bundle) {
    let Gaze {
        up,
        depth,
        farthest,
        around,
    } = gaze;
    for i in 0..BATCH {
        let v = [0, 1, 2].map(|axis| {
            spots.normal[axis][i] * ahead + spots.first[axis][i] * along + spots.second[axis][i] * aside
        });
        let from = [0, 1, 2].map(|axis| spots.from[axis][i]);
        let rise = v[0] * up[0] + v[1] * up[1] + v[2] * up[2];
        let under = depth - (from[0] * up[0] + from[1] * up[1] + from[2] * up[2]);
        let under = if under > 0.0 { under } else { 0.0 };
        let steep = if rise > 1e-6 { rise } else { 1e-6 };
        let to_sea = under / steep;
        let meters = if rise > 0.0 { to_sea } else { farthest };
        let meters = if meters < farthest { meters } else { farthest };
        for axis in 0..3 {
            bundle.to[axis][i] = from[axis] + v[axis] * meters;
        }
        for c in 0..3 {
            bundle.light[c][i] = exp_negative(-horner(around[c], rise));
        }
    }
}
