//! Shafts of light: the pattern in the water before the surfaces. For looks; nothing is promised of how near the truth they are.

use imaging::{Plane, Rgb};

use super::super::{Daylight, SunLight};
use super::lookup::{Footprint, pattern_at};
use super::tile::Tiles;
use crate::range::is_hole;

/// Places along each ray.
const PLACES: usize = 16;
/// Every so many pixels has a ray of its own.
const STRIDE: usize = 4;
/// Attenuation lengths of a ray that meets no surface.
const FARTHEST: f64 = 8.0;

/// `Σ w C(x)` of every pixel: the mean of the pattern at 16 places of its ray, equal in `1 − e^{−c t}` up to its surface. It is computed
/// for every fourth pixel of every fourth row, and between.
#[must_use]
pub fn shafts(
    range: &Plane<f32>,
    daylight: &Daylight,
    sun: &SunLight,
    tiles: &Tiles,
    attenuation: f64,
) -> Plane<f32> {
    let footprint = Footprint::new(daylight, sun);
    let gaze = &daylight.gaze;
    let (width, height) = range.size();
    let at = |x: usize, y: usize| -> f32 {
        let (x, y) = ((x * STRIDE).min(width - 1), (y * STRIDE).min(height - 1));
        let ray = gaze.camera.ray(x as f64, y as f64).normalized();
        let rise = gaze.rise(x, y);
        let surface = if rise > 0.0 {
            daylight.depth / rise
        } else {
            f64::INFINITY
        };
        let z = range.pixel(x, y);
        let end = if is_hole(z) {
            FARTHEST / attenuation.max(1e-6)
        } else {
            f64::from(z)
        };
        let end = end.min(surface);
        let lost = -(-attenuation * end).exp_m1();
        let of_place = |k: usize| {
            let share = (k as f64 + 0.5) / PLACES as f64;
            let t = if attenuation * end < 1e-6 {
                share * end
            } else {
                -(-share * lost).ln_1p() / attenuation
            };
            let (depth, entry) = footprint.of((ray * t).into());
            pattern_at(tiles, depth, entry)
        };
        (0..PLACES).map(of_place).sum::<f32>() / PLACES as f32
    };
    let coarse = Plane::from_fn(width.div_ceil(STRIDE) + 1, height.div_ceil(STRIDE) + 1, at);
    Plane::from_fn(width, height, |x, y| {
        let (i, j) = (x / STRIDE, y / STRIDE);
        let [s, t] = [x, y].map(|at| (at % STRIDE) as f32 / STRIDE as f32);
        let above = coarse.pixel(i, j) * (1.0 - s) + coarse.pixel(i + 1, j) * s;
        let below = coarse.pixel(i, j + 1) * (1.0 - s) + coarse.pixel(i + 1, j + 1) * s;
        above * (1.0 - t) + below * t
    })
}

/// Multiplies the sun's share of the veil by the shafts: adds what that changes to `light` as well.
pub fn with_shafts(
    veil: &mut Rgb<f32>,
    light: &mut Rgb<f32>,
    shafts: &Plane<f32>,
    daylight: &Daylight,
    sun: &SunLight,
) {
    let channels = veil.planes_mut().into_iter().zip(light.planes_mut());
    for (c, (veil, light)) in channels.enumerate() {
        let share = sun.share_at(&daylight.fields[c], daylight.depth) as f32;
        for ((veil, light), &shaft) in veil.iter_mut().zip(light).zip(shafts.data()) {
            let change = *veil * share * (shaft - 1.0);
            *veil += change;
            *light += change;
        }
    }
}
