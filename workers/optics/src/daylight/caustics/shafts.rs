//! Shafts of light: the pattern in the water in front of the surfaces. A visual effect without an error bound.

use imaging::{Plane, Rgb, vectorized};

use super::super::SunLight;
use super::lookup::{Footprint, LookUp};
use super::tile::Tiles;
use crate::daylight::conditions::Daylight;
use crate::range::is_hole;

/// Samples along each ray.
const PLACES: usize = 16;
/// Pixels from one ray to the next.
const STRIDE: usize = 8;
/// Attenuation lengths of a ray without a surface.
const FARTHEST: f64 = 8.0;

/// `Σ w C(x)` of every pixel: the mean of the pattern at 16 points of its ray, equally spaced in `1 − e^{−c t}` up to its surface.
/// It is computed for every eighth pixel of every eighth row, and interpolated between.
#[must_use]
pub fn shafts(
    range: &Plane<f32>,
    daylight: &Daylight,
    sun: &SunLight,
    tiles: &Tiles,
    attenuation: f64,
) -> Plane<f32> {
    let footprint = Footprint::new(daylight, sun);
    let look = LookUp::new(tiles);
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
            look.at(depth, entry)
        };
        (0..PLACES).map(of_place).sum::<f32>() / PLACES as f32
    };
    let (columns, rows) = (width.div_ceil(STRIDE) + 1, height.div_ceil(STRIDE) + 1);
    let coarse = Plane::from_fn(columns, rows, at);
    let mut fine = Plane::filled(width, height, 0.0f32);
    let mut between = vec![0.0f32; columns];
    for y in 0..height {
        let t = (y % STRIDE) as f32 / STRIDE as f32;
        let ends = coarse.row(y / STRIDE).iter().zip(coarse.row(y / STRIDE + 1));
        for (to, (above, below)) in between.iter_mut().zip(ends) {
            *to = above + (below - above) * t;
        }
        for (to, ends) in fine.row_mut(y).chunks_mut(STRIDE).zip(between.windows(2)) {
            for (step, to) in to.iter_mut().enumerate() {
                *to = ends[0] + (ends[1] - ends[0]) * (step as f32 / STRIDE as f32);
            }
        }
    }
    fine
}

/// Multiplies the sun's share of the veil by the shafts, and adds the change to `light` as well. The share is that of the ray in
/// the middle of the picture, an attenuation length long.
pub fn with_shafts(veil: &mut Rgb<f32>, light: &mut Rgb<f32>, shafts: &Plane<f32>, daylight: &Daylight) {
    let camera = &daylight.gaze.camera;
    let ray = camera.ray(camera.cx, camera.cy).normalized();
    let length = 1.0 / daylight.fields[1].attenuation.max(1e-6);
    let share = daylight.sun_share_of_veil(ray.into(), length) as f32;
    for (veil, light) in veil.planes_mut().into_iter().zip(light.planes_mut()) {
        vectorized!(change(veil, light, shafts.data(), share));
    }
}

#[inline(always)]
fn change(veil: &mut [f32], light: &mut [f32], shafts: &[f32], share: f32) {
    for ((veil, light), &shaft) in veil.iter_mut().zip(light).zip(shafts) {
        let change = *veil * share * (shaft - 1.0);
        *veil += change;
        *light += change;
    }
}
