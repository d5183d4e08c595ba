//! The light of lamps on surfaces in f64, for tiles with too much rounding in f32: next to a lamp and far from the camera, or at
//! grazing incidence.

use std::f64::consts::PI;

use imaging::vector::dot;
use imaging::{Plane, Rgb};

use super::shade::{RowShade, Shade};
use crate::lamp::Lighting;
use crate::lamp::point::{Arriving, SeenPoint};
use crate::range::is_hole;
use crate::visible_bounds::TILE_PX;

/// A surface point: its column, its ray from the camera, its range and its normal.
struct Point {
    x: usize,
    ray: [f64; 3],
    range_m: f64,
    normal: [f64; 3],
}

/// Replaces the light of the pixels of tiles, with the shadows that the f32 form found.
pub(super) fn replace(
    tiles: &[bool],
    (range, normals): (&Plane<f32>, &[Plane<f32>; 3]),
    (lighting, shades): (&Lighting, &[Option<Shade>]),
    light: &mut Rgb<f32>,
) {
    let columns = range.width().div_ceil(TILE_PX).max(1);
    for (row, tiles) in tiles
        .chunks(columns)
        .enumerate()
        .filter(|(_, tiles)| tiles.contains(&true))
    {
        for y in row * TILE_PX..((row + 1) * TILE_PX).min(range.height()) {
            let shades = shades
                .iter()
                .map(|shade| shade.as_ref().map(|shade| shade.of_row(y)));
            let shades: Vec<Option<RowShade<'_>>> = shades.collect();
            for x in (0..range.width()).filter(|x| tiles[x / TILE_PX] && !is_hole(range.pixel(*x, y))) {
                let ray: [f64; 3] = lighting.camera.ray(x as f64, y as f64).into();
                let length = dot(ray, ray).sqrt();
                let point = Point {
                    x,
                    ray: ray.map(|v| v / length),
                    range_m: f64::from(range.pixel(x, y)),
                    normal: normals.each_ref().map(|plane| f64::from(plane.pixel(x, y))),
                };
                let sums = sum_up(&point, lighting, &shades);
                for (plane, sum) in light.planes_mut().into_iter().zip(sums) {
                    plane[y * range.width() + x] = sum as f32;
                }
            }
        }
    }
}

fn sum_up(point: &Point, lighting: &Lighting, shades: &[Option<RowShade<'_>>]) -> [f64; 3] {
    let place = point.ray.map(|v| v * point.range_m);
    let seen = SeenPoint::new((point.ray, point.range_m), place, lighting);
    let mut sum = [0.0; 3];
    for (lamp, shade) in lighting.lamps.iter().zip(shades) {
        let to_lamp = [0, 1, 2].map(|i| lamp.position_m[i] - place[i]);
        let distance = dot(to_lamp, to_lamp).sqrt().max(lighting.radius_m);
        let facing = PI * dot(point.normal, to_lamp).max(0.0) / distance;
        let arriving = Arriving::new(&seen, lamp, lighting);
        let direct = shade.map_or(1.0, |shade| f64::from(shade.direct[point.x]));
        for i in 0..3 {
            sum[i] += facing * direct * arriving.direct[i];
            if lighting.absorption.is_some() {
                let spread = shade.map_or(1.0, |shade| f64::from(shade.spread[i][point.x]));
                sum[i] += facing * spread * arriving.spread[i];
            }
        }
    }
    sum
}
