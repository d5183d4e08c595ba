//! The light of lamps on surfaces in f64, for pixels on which f32 might lose too much of it: next to a lamp and far from the camera,
//! or on surfaces that the light only grazes.

use std::f64::consts::PI;

use imaging::Plane;
use imaging::vector::dot;

use super::shade::{RowShade, Shade};
use super::{Rounding, STEP};
use crate::extremes::greatest;
use crate::lamp::Lighting;
use crate::lamp::point::Arriving;
use crate::range::is_hole;

/// Pixels of a run that is computed in f64 as a whole.
const RUN: usize = 32;
/// Less light than this is lost in f32.
const DARKEST: f64 = f32::MIN_POSITIVE as f64;

/// Rounding of the runs of a row, and the limit above which they are computed in f64.
pub(super) struct Precise<'a> {
    lighting: &'a Lighting,
    limit: f64,
    /// Of lamps whose rounding is small on all of the row.
    small: f64,
    /// Of the other lamps, run by run.
    runs: Vec<f64>,
}

/// A pixel: its column and row, its range and its normal.
struct Pixel {
    at: (usize, usize),
    range_m: f64,
    normal: [f64; 3],
}

impl<'a> Precise<'a> {
    pub(super) fn new(lighting: &'a Lighting, width: usize, limit: f64) -> Self {
        Self {
            lighting,
            limit,
            small: 0.0,
            runs: vec![0.0; width.div_ceil(RUN)],
        }
    }

    pub(super) fn start_row(&mut self) {
        self.small = 0.0;
        self.runs.fill(0.0);
    }

    /// Adds the rounding of a lamp from the inverse distances and the ratios of ranges and distances of the row.
    pub(super) fn include(&mut self, rounding: &Rounding, near: &[f32], seen: &[f32]) {
        let whole = rounding.within(greatest(near), greatest(seen));
        if whole * self.lighting.lamps.len() as f64 <= self.limit {
            self.small += whole;
            return;
        }
        for ((run, near), seen) in self.runs.iter_mut().zip(near.chunks(RUN)).zip(seen.chunks(RUN)) {
            *run += rounding.within(greatest(near), greatest(seen));
        }
    }

    /// Computes the runs above the limit in f64. Returns the largest rounding of the row.
    pub(super) fn finish_row(
        &self,
        y: usize,
        (range, normals): (&Plane<f32>, &[Plane<f32>; 3]),
        shades: &[Option<Shade>],
        mut to: [&mut [f32]; 3],
    ) -> f64 {
        let shades: Vec<Option<RowShade<'_>>> = shades
            .iter()
            .map(|shade| shade.as_ref().map(|shade| shade.of_row(y)))
            .collect();
        let mut worst = 0.0f64;
        for (run, rounding) in self.runs.iter().map(|run| run + self.small).enumerate() {
            if rounding <= self.limit {
                worst = worst.max(rounding);
                continue;
            }
            for x in run * RUN..((run + 1) * RUN).min(range.width()) {
                let pixel = Pixel {
                    at: (x, y),
                    range_m: f64::from(range.pixel(x, y)),
                    normal: normals.each_ref().map(|plane| f64::from(plane.pixel(x, y))),
                };
                let light = self.light(&pixel, &shades);
                for (to, light) in to.iter_mut().zip(light) {
                    to[x] = light as f32;
                    worst = worst.max(STEP * light + DARKEST);
                }
            }
        }
        worst
    }

    fn light(&self, pixel: &Pixel, shades: &[Option<RowShade<'_>>]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        if is_hole(pixel.range_m) {
            return sum;
        }
        let (lighting, (x, y)) = (self.lighting, pixel.at);
        let ray: [f64; 3] = lighting.camera.ray(x as f64, y as f64).into();
        let length = dot(ray, ray).sqrt();
        let ray = ray.map(|v| v / length);
        let place = ray.map(|v| v * pixel.range_m);
        for (lamp, shade) in lighting.lamps.iter().zip(shades) {
            let to_lamp = [0, 1, 2].map(|i| lamp.position_m[i] - place[i]);
            let distance = dot(to_lamp, to_lamp).sqrt().max(lighting.radius_m);
            let facing = PI * dot(pixel.normal, to_lamp).max(0.0) / distance;
            let arriving = Arriving::on_ray((ray, pixel.range_m), place, lamp, lighting);
            let direct = shade.map_or(1.0, |shade| f64::from(shade.direct[x]));
            for i in 0..3 {
                sum[i] += facing * direct * arriving.direct[i];
                if lighting.absorption.is_some() {
                    let spread = shade.map_or(1.0, |shade| f64::from(shade.spread[i][x]));
                    sum[i] += facing * spread * arriving.spread[i];
                }
            }
        }
        sum
    }
}
