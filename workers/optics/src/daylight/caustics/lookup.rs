//! The pattern on the surfaces of a picture.

use imaging::{Plane, vectorized};

use super::super::SunLight;
use super::super::rises::{Row, rises_of};
use super::Waves;
use super::tile::Tiles;
use crate::attenuation::masked;
use crate::daylight::conditions::Daylight;
use crate::range::is_hole;

/// Tiles of one side hold every depth of a cell next to each other, up to this number.
const MOST_SLICES: usize = 8;

/// Entry point into the water of the light at a point: the horizontal axes, and the sideways shift of sunlight for each meter of
/// depth.
#[derive(Debug, Clone, Copy)]
pub(super) struct Footprint {
    axes: [[f64; 3]; 2],
    place: [f64; 2],
    aside: [f64; 2],
    up: [f64; 3],
    /// True meters of one length of the range.
    scale: f64,
    depth: f64,
}

impl Footprint {
    pub(super) fn new(daylight: &Daylight, sun: &SunLight) -> Self {
        let steep = (1.0 - sun.rise * sun.rise).max(0.0).sqrt() / sun.rise;
        let (sine, cosine) = sun.azimuth.sin_cos();
        Self {
            axes: daylight.gaze.level,
            place: daylight.gaze.place,
            aside: [steep * cosine, steep * sine],
            up: daylight.gaze.up,
            scale: daylight.scale,
            depth: daylight.depth,
        }
    }

    /// Depth and entry point in true meters for a point in camera axes.
    pub(super) fn of(&self, place: [f64; 3]) -> (f64, [f64; 2]) {
        let dot = |a: [f64; 3]| a[0] * place[0] + a[1] * place[1] + a[2] * place[2];
        let depth = self.scale * (self.depth - dot(self.up)).max(0.0);
        let entry = [0, 1].map(|i| self.scale * (dot(self.axes[i]) + self.place[i]) + depth * self.aside[i]);
        (depth, entry)
    }
}

/// C at a depth and an entry point, from tiles in f64: bilinear in the tile and linear between depths.
pub(super) fn pattern(
    tiles: &[Plane<f64>],
    depths_m: &[f64],
    waves: &Waves,
    depth_m: f64,
    entry: [f64; 2],
) -> f64 {
    let cells = waves.cells;
    let [u, v] = entry.map(|at| (at / waves.tile_m * cells as f64 - 0.5).rem_euclid(cells as f64));
    let (x, y) = (u as usize % cells, v as usize % cells);
    let (s, t) = (u - u.floor(), v - v.floor());
    let (right, below) = ((x + 1) % cells, (y + 1) % cells);
    let at = |tile: &Plane<f64>| {
        let above = tile.pixel(x, y) * (1.0 - s) + tile.pixel(right, y) * s;
        let under = tile.pixel(x, below) * (1.0 - s) + tile.pixel(right, below) * s;
        above * (1.0 - t) + under * t
    };
    let last = depths_m.len() - 1;
    let depth = depth_m.clamp(depths_m[0], depths_m[last]);
    let k = depths_m[1..].iter().take_while(|&&slice| slice < depth).count();
    if k >= last {
        return at(&tiles[last]);
    }
    let share = (depth - depths_m[k]) / (depths_m[k + 1] - depths_m[k]);
    at(&tiles[k]) * (1.0 - share) + at(&tiles[k + 1]) * share
}

/// C of every pixel's surface from tiles in f64; 1 at holes.
///
/// # Panics
/// Without a sun.
#[must_use]
pub fn caustics_reference(
    range: &Plane<f64>,
    daylight: &Daylight,
    waves: &Waves,
    (tiles, depths_m): (&[Plane<f64>], &[f64]),
) -> Plane<f64> {
    let sun = daylight.sun.expect("caustics are of sunlight");
    let footprint = Footprint::new(daylight, &sun);
    let camera = daylight.gaze.camera;
    Plane::from_fn(range.width(), range.height(), |x, y| {
        let z = range.pixel(x, y);
        if is_hole(z) {
            return 1.0;
        }
        let ray = camera.ray(x as f64, y as f64).normalized();
        let (depth, entry) = footprint.of((ray * z).into());
        pattern(tiles, depths_m, waves, depth, entry)
    })
}

impl Daylight {
    /// Least and greatest depth in true meters of the surfaces in a picture; `None` in a frame of holes.
    #[must_use]
    pub fn depths_m(&self, range: &Plane<f32>) -> Option<(f64, f64)> {
        let mut rises = vec![0.0f32; range.width()];
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        for y in 0..range.height() {
            let row = Row::new(&self.gaze, y);
            vectorized!(rises_of(row, &mut rises));
            let (least, most) = vectorized!(heights(range.row(y), &rises));
            (low, high) = (low.min(least), high.max(most));
        }
        let depth = |height: f32| self.scale * (self.depth - f64::from(height)).max(0.0);
        (low <= high).then(|| (depth(high), depth(low)))
    }
}

/// Least and greatest height above the camera in a row.
#[inline(always)]
fn heights(range: &[f32], rises: &[f32]) -> (f32, f32) {
    const LANES: usize = 16;
    let (mut low, mut high) = ([f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]);
    for (range, rises) in range.chunks(LANES).zip(rises.chunks(LANES)) {
        for (((low, high), &z), &rise) in low.iter_mut().zip(&mut high).zip(range).zip(rises) {
            let counts = (z >= crate::range::SHORTEST_M as f32) & (z <= f32::MAX);
            let height = z * rise;
            let (least, most) = if counts {
                (height, height)
            } else {
                (f32::INFINITY, f32::NEG_INFINITY)
            };
            *low = if least < *low { least } else { *low };
            *high = if most > *high { most } else { *high };
        }
    }
    let least = low.into_iter().fold(f32::INFINITY, f32::min);
    (least, high.into_iter().fold(f32::NEG_INFINITY, f32::max))
}

/// A row in cells of the tile: `depth`, and the entry point along both axes, as linear functions of the range.
#[derive(Clone, Copy)]
struct Trace {
    inverse_focal: f32,
    cx: f32,
    /// Of each of up, first and second axis: growth with u, and the rest of the row.
    growth: [[f32; 2]; 3],
    square: f32,
    depth: f32,
    scale: f32,
    /// Cells a true meter.
    per_m: f32,
    /// Position of the camera in cells.
    place: [f32; 2],
    /// Cells aside in each meter of depth.
    aside: [f32; 2],
}

impl Trace {
    fn new(footprint: &Footprint, daylight: &Daylight, waves: &Waves, y: usize) -> Self {
        let camera = &daylight.gaze.camera;
        let v = (y as f64 - camera.cy) / camera.focal_px;
        let per_m = waves.cells as f64 / waves.tile_m;
        let axes = [footprint.up, footprint.axes[0], footprint.axes[1]];
        // Whole tiles are subtracted from the position while it is in f64.
        let place = footprint
            .place
            .map(|at| (at * footprint.scale).rem_euclid(waves.tile_m) * per_m - 0.5);
        Self {
            inverse_focal: (1.0 / camera.focal_px) as f32,
            cx: camera.cx as f32,
            growth: axes.map(|[x, down, ahead]| [x as f32, (down * v + ahead) as f32]),
            square: (v * v + 1.0) as f32,
            depth: footprint.depth as f32,
            scale: footprint.scale as f32,
            per_m: per_m as f32,
            place: place.map(|at| at as f32),
            aside: footprint.aside.map(|at| (at * per_m) as f32),
        }
    }
}

/// Lookup positions of the pixels of a row.
struct Spots {
    depth: Vec<f32>,
    entry: [Vec<f32>; 2],
}

#[inline(always)]
fn trace(of: Trace, range: &[f32], depth: &mut [f32], first: &mut [f32], second: &mut [f32]) {
    let len = range.len();
    let (depth, first, second) = (&mut depth[..len], &mut first[..len], &mut second[..len]);
    for i in 0..len {
        let u = (i as i32 as f32 - of.cx) * of.inverse_focal;
        let (valid, z) = masked(range[i]);
        let z = if valid { z } else { 0.0 } / (u * u + of.square).sqrt();
        let [above, east, north] = of.growth.map(|[growth, rest]| (growth * u + rest) * z);
        let under = of.depth - above;
        let under = of.scale * if under > 0.0 { under } else { 0.0 };
        depth[i] = under;
        first[i] = of.place[0] + of.scale * of.per_m * east + of.aside[0] * under;
        second[i] = of.place[1] + of.scale * of.per_m * north + of.aside[1] * under;
    }
}

/// Multiplies the sunlight on the surfaces of a picture by the pattern. Pixels without sunlight are unchanged.
///
/// # Panics
/// When the planes are of different sizes.
pub fn caustics(
    range: &Plane<f32>,
    daylight: &Daylight,
    sun: &SunLight,
    tiles: &Tiles,
    light: &mut Plane<f32>,
) {
    assert_eq!(range.size(), light.size(), "one light for each pixel");
    let footprint = Footprint::new(daylight, sun);
    let width = range.width();
    let blank = || vec![0.0f32; width];
    let mut spots = Spots {
        depth: blank(),
        entry: [blank(), blank()],
    };
    let steps = Steps::new(&tiles.depths_m);
    for y in 0..range.height() {
        let of = Trace::new(&footprint, daylight, &tiles.waves, y);
        let Spots {
            depth,
            entry: [first, second],
        } = &mut spots;
        vectorized!(trace(of, range.row(y), depth, first, second));
        let row = light.row_mut(y);
        for (i, light) in row.iter_mut().enumerate() {
            if *light > 0.0 {
                *light *= look_up(tiles, &steps, depth[i], [first[i], second[i]]);
            }
        }
    }
}

/// The two depths around a given one.
struct Steps {
    starts: [f32; MOST_SLICES],
    inverse: [f32; MOST_SLICES],
    last: usize,
}

impl Steps {
    fn new(depths_m: &[f64]) -> Self {
        let mut steps = Self {
            starts: [f32::INFINITY; MOST_SLICES],
            inverse: [0.0; MOST_SLICES],
            last: depths_m.len() - 1,
        };
        for (k, &depth) in depths_m.iter().enumerate() {
            steps.starts[k] = depth as f32;
            if k < steps.last {
                steps.inverse[k] = (1.0 / (depths_m[k + 1] - depth)) as f32;
            }
        }
        steps
    }

    /// The slice above a depth, and the interpolation weight of the next.
    #[inline(always)]
    fn find(&self, depth: f32) -> (usize, f32) {
        let k = self.starts[1..].iter().filter(|&&start| start < depth).count();
        let k = k.min(self.last.saturating_sub(1));
        let share = (depth - self.starts[k]) * self.inverse[k];
        (k, share.clamp(0.0, 1.0))
    }
}

#[inline(always)]
fn look_up(tiles: &Tiles, steps: &Steps, depth: f32, [u, v]: [f32; 2]) -> f32 {
    let (cells, count) = (tiles.waves.cells, steps.last + 1);
    let mask = cells - 1;
    let (left, top) = (u.floor(), v.floor());
    let (s, t) = (u - left, v - top);
    let cell = |at: f32| (at as i32 as usize) & mask;
    let (x, y) = (cell(left), cell(top));
    let (right, below) = ((x + 1) & mask, (y + 1) & mask);
    let (k, share) = steps.find(depth);
    let next = (k + 1).min(steps.last);
    let at = |x: usize, y: usize| {
        let slices = &tiles.values[(y * cells + x) * count..][..count];
        slices[k] + (slices[next] - slices[k]) * share
    };
    let above = at(x, y) * (1.0 - s) + at(right, y) * s;
    let under = at(x, below) * (1.0 - s) + at(right, below) * s;
    above * (1.0 - t) + under * t
}

/// C in f32 at single points.
pub(super) struct LookUp<'a> {
    tiles: &'a Tiles,
    steps: Steps,
}

impl<'a> LookUp<'a> {
    pub(super) fn new(tiles: &'a Tiles) -> Self {
        let steps = Steps::new(&tiles.depths_m);
        Self { tiles, steps }
    }

    /// At a depth and an entry point in true meters.
    pub(super) fn at(&self, depth_m: f64, entry: [f64; 2]) -> f32 {
        let waves = &self.tiles.waves;
        let per_m = waves.cells as f64 / waves.tile_m;
        let place = entry.map(|at| (at * per_m - 0.5) as f32);
        look_up(self.tiles, &self.steps, depth_m as f32, place)
    }
}
