//! Spread light of pixels, read between the rays about them.

use std::f32::consts::FRAC_PI_2;

use imaging::vectorized;

use super::super::intervals::{Intervals, Rays, rays_of};
use super::super::{Lanes, RUN};
use super::strip::Strip;
use super::{CELLS, Frame, STEP, VALUES, whole};

/// What f32 may lose of the place in a cell, in cells.
const PLACE: f64 = 3e-5;

impl Frame<'_> {
    /// Adds what is read between the strips of two rows to the pixels of a row of blocks. Returns what f32 may lose.
    pub(super) fn read(
        &self,
        [above, below]: [&[Strip]; 2],
        row: usize,
        read: &[bool],
        glow: &mut [Vec<f32>; 3],
    ) -> f64 {
        let (width, height) = self.range.size();
        let mut rounding = 0.0f64;
        let mut between: Vec<Vec<_>> = above.iter().map(|strip| strip.rays.clone()).collect();
        for y in row * STEP..height.min((row + 1) * STEP) {
            let share = (y - row * STEP) as f32 / STEP as f32;
            for ((above, below), between) in above.iter().zip(below).zip(&mut between) {
                vectorized!(mix(
                    above.rays.as_flattened(),
                    below.rays.as_flattened(),
                    share,
                    between.as_flattened_mut()
                ));
            }
            for x in (0..width).step_by(RUN) {
                rounding = rounding.max(self.read_run(&between, (x, y), read, glow));
            }
        }
        rounding
    }

    fn read_run(
        &self,
        between: &[Vec<[[f32; VALUES]; CELLS]>],
        (start, y): (usize, usize),
        read: &[bool],
        glow: &mut [Vec<f32>; 3],
    ) -> f64 {
        let width = self.range.width();
        let run = RUN.min(width - start);
        let first = y * width + start;
        let mut range_m = [f32::INFINITY; RUN];
        range_m[..run].copy_from_slice(&self.range.row(y)[start..start + run]);
        let mut rays = Rays::default();
        vectorized!(rays_of(self.lens, (start, y), &range_m, &mut rays));
        let murk = self.murkiness.of_run(first, run);
        let (intervals, span) = vectorized!(whole(self.lamp, &rays, &murk));
        let mut places = [0.0f32; RUN];
        vectorized!(places_of(&intervals, &mut places));
        let (mut most, mut steepest) = (0.0f32, 0.0f32);
        for i in (0..run).filter(|&i| read[(start + i) / STEP]) {
            let x = start + i;
            // The first ray lies before the frame.
            let block = x / STEP + 1;
            let share = (x % STEP) as f32 / STEP as f32;
            let cell = (places[i] as usize).min(CELLS - 1);
            let u = places[i] - cell as f32;
            let (degree, weights) = self.murkiness.weights(murk.path[i]);
            let mut sum = [0.0f32; 3];
            for (between, weight) in between[degree..].iter().zip(weights) {
                let (a, b) = (&between[block][cell], &between[block + 1][cell]);
                for channel in 0..3 {
                    let at = |values: &[f32; VALUES]| {
                        values[channel] + u * (values[channel + 3] + values[channel + 6] * (u - 1.0))
                    };
                    sum[channel] += weight * (at(a) + share * (at(b) - at(a)));
                    steepest = steepest.max(murk.source[i] * a[channel + 3].max(b[channel + 3]));
                }
            }
            for channel in 0..3 {
                let light = murk.source[i] * sum[channel].max(0.0);
                glow[channel][first + i] += light;
                most = most.max(light);
            }
        }
        if most > 0.0 {
            self.lamp.rounding.within(span, most) + PLACE * f64::from(steepest)
        } else {
            0.0
        }
    }
}

/// Where in its cells each ray ends.
#[inline(always)]
fn places_of(to: &Intervals, places: &mut Lanes) {
    for i in 0..RUN {
        let whole = FRAC_PI_2 - to.from[i];
        places[i] = (2.0 * CELLS as f32 * to.half[i] / whole).min(CELLS as f32);
    }
}

#[inline(always)]
fn mix(a: &[[f32; VALUES]], b: &[[f32; VALUES]], share: f32, to: &mut [[f32; VALUES]]) {
    let (a, b) = (a.as_flattened(), b.as_flattened());
    for ((to, a), b) in to.as_flattened_mut().iter_mut().zip(a).zip(b) {
        *to = share.mul_add(b - a, *a);
    }
}
