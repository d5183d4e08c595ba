//! The glow of light from a spot that was spread on its way: S̄ (e^{−c_g L} − e^{−c L}) along the whole ray, in its cone or not.
//!
//! It changes little from pixel to pixel but with the range, and S̄ costs more than all else of a node, even from a table.
//! So its sum from the camera up to each of 32 equal angles is taken along the rays of every eighth pixel only, and read between
//! them at the angle that a pixel's own range ends at. What that may leave is seen from the second differences between the rays;
//! where it is too much, pixels are summed up each by itself. In patches the sums are taken at a few degrees of murkiness.

mod murkiness;
mod read;
mod strip;

use std::f32::consts::FRAC_PI_2;

use imaging::{Plane, vectorized};

use super::super::nodes;
use super::composite::{self, Sum};
use super::integrand::SpreadNode;
use super::intervals::{Intervals, Murk, Rays, extreme, intervals, murk_of, rays_of};
use super::{Errors, Glow, Lanes, RUN};
use crate::lamp::Lighting;
use crate::turbidity;
use murkiness::Murkiness;
use strip::Strip;

/// Every such column and row has a ray; a block of so many pixels a side is a run.
const STEP: usize = 8;
const _: () = assert!(STEP * STEP == RUN);
/// Equal angles of a ray.
const CELLS: usize = 32;
/// Sum up to a cell, in it, and its slope there, of three channels.
const VALUES: usize = 9;
/// By this the second differences between rays, and the changes of slope from cell to cell, exceed the error.
const BETWEEN_RAYS: f64 = 0.4;
const BETWEEN_CELLS: f64 = 0.2;
/// Third differences between degrees of murkiness exceed the error of a parabola, at most 0.064 of them, by this.
const BETWEEN_DEGREES: f64 = 0.2;
/// Between two rays the lamp is seen from directions no farther apart than this share of its cone: a narrow beam might pass between
/// them and be seen by neither.
const SHARE_OF_CONE: f32 = 0.125;
/// Along a ray, nodes lie at most this share of the cone apart, in β.
const NODES_OF_CONE: f32 = 0.35;

/// Adds the light of a spot that was spread on its way.
pub(super) fn add(
    range: &Plane<f32>,
    lighting: &Lighting,
    lamp: &Glow,
    rules: &[Vec<[f32; 2]>],
    glow: &mut [Vec<f32>; 3],
) -> Errors {
    let camera = &lighting.camera;
    let mut frame = Frame {
        range,
        lens: [1.0 / camera.focal_px, camera.cx, camera.cy].map(|v| v as f32),
        patches: (lighting.patches.as_ref()).map(|field| turbidity::Rays::new(field, camera)),
        murkiness: Murkiness::even(),
        lamp,
        rules,
    };
    let (columns, rows) = (range.width().div_ceil(STEP), range.height().div_ceil(STEP));
    let mut errors = Errors::default();
    if lamp.fixed.is_some() {
        for block in (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row))) {
            errors.include(frame.sum_up(block, glow));
        }
        return errors;
    }
    frame.murkiness = Murkiness::met(&frame);
    let source = f64::from(frame.murkiness.source());
    // Rays of one row of blocks and the next, with one beyond each.
    let mut lines: [Vec<Strip>; 4] = std::array::from_fn(|i| frame.strips(i as i64 - 1, columns));
    for row in 0..rows {
        let left = strip::left([&lines[0], &lines[1], &lines[2]]);
        let next = strip::left([&lines[1], &lines[2], &lines[3]]);
        let worst = |column: usize| [left[column], left[column + 1], next[column], next[column + 1]];
        let worst: Vec<f64> = (0..columns)
            .map(|column| source * worst(column).into_iter().fold(0.0, f64::max))
            .collect();
        let nearest = |column: usize| {
            let [above, below] = [&lines[1][0].distance, &lines[2][0].distance];
            let ends = [column + 1, column + 2].map(|at| above[at].min(below[at]));
            ends[0].min(ends[1])
        };
        let is_read = |column: usize| {
            let is_wide = FRAC_PI_2 <= frame.spacing() * 2.0 * CELLS as f32;
            is_wide && worst[column] <= lamp.source.tolerance && frame.turn(nearest(column)) <= SHARE_OF_CONE
        };
        for column in (0..columns).filter(|&column| !is_read(column)) {
            errors.include(frame.sum_up((column, row), glow));
        }
        let read: Vec<bool> = (0..columns).map(is_read).collect();
        let rounding = frame.read([&lines[1], &lines[2]], row, &read, glow);
        let left = (0..columns)
            .filter(|&column| read[column])
            .map(|column| worst[column]);
        errors.include(Errors {
            left: left.fold(0.0, f64::max),
            rounding,
        });
        lines.rotate_left(1);
        lines[3] = frame.strips(row as i64 + 3, columns);
    }
    errors
}

/// What a spot is added to.
struct Frame<'a> {
    range: &'a Plane<f32>,
    lens: [f32; 3],
    patches: Option<turbidity::Rays>,
    murkiness: Murkiness,
    lamp: &'a Glow,
    rules: &'a [Vec<[f32; 2]>],
}

impl Frame<'_> {
    /// By which share of its cone the direction to the lamp turns at most from a ray to the next.
    fn turn(&self, nearest_m: f32) -> f32 {
        let [x, y, z] = self.lamp.place;
        let away = x.mul_add(x, y.mul_add(y, z * z)).sqrt();
        let step = STEP as f32 * self.lens[0] * (away / nearest_m).max(1.0);
        step / self.lamp.profile.cos_cone.acos()
    }

    /// How far apart nodes in β may lie: some in each of the widths that the profile of the lamp changes over.
    fn spacing(&self) -> f32 {
        let of_cone = NODES_OF_CONE * self.lamp.profile.cos_cone.acos();
        of_cone.min(composite::spacing(self.lamp.source.asymmetry))
    }

    /// The sum over a fixed rule.
    fn at_fixed(&self, intervals: &Intervals, count: usize) -> Sum {
        let lamp = self.lamp;
        let mut light = [[0.0f32; RUN]; 3];
        let (mut spread, mut angles) = (SpreadNode::dark(), [0.0f32; RUN]);
        let both = |&[node, weight]: &[f32; 2]| [[node, weight], [-node, weight]];
        for [node, weight] in self.rules[count / 2].iter().flat_map(both) {
            vectorized!(angles_of(intervals, 1.0 + node, &mut angles));
            spread.shine(lamp, intervals, &angles);
            for (light, spread) in light.iter_mut().zip(&spread.light) {
                for i in 0..RUN {
                    light[i] = weight.mul_add(spread[i], light[i]);
                }
            }
        }
        for (light, gain) in light.iter_mut().zip(lamp.gain) {
            for i in 0..RUN {
                light[i] *= gain * intervals.scale[i];
            }
        }
        Sum { light, left: 0.0 }
    }

    /// Adds to the pixels of a block what is summed up along each of their rays.
    fn sum_up(&self, (column, row): (usize, usize), glow: &mut [Vec<f32>; 3]) -> Errors {
        let (width, height) = self.range.size();
        let (lamp, start) = (self.lamp, (column * STEP, row * STEP));
        let at = |i: usize| (start.0 + i % STEP, start.1 + i / STEP);
        let mut errors = Errors::default();
        // Rows of a block one after the other: rays and patches are made for runs of a row.
        let mut rays = Rays::default();
        let mut murk = Murk::default();
        for y in 0..STEP {
            let mut range_m = [f32::INFINITY; RUN];
            for (x, range_m) in range_m.iter_mut().enumerate().take(STEP) {
                let place = (start.0 + x, start.1 + y);
                if place.0 < width && place.1 < height {
                    *range_m = self.range.pixel(place.0, place.1);
                }
            }
            let (mut line, mut line_murk) = (Rays::default(), Murk::default());
            let place = (start.0, start.1 + y);
            vectorized!(rays_of(self.lens, place, &range_m, &mut line));
            if let Some(patches) = &self.patches {
                vectorized!(murk_of(lamp, &line, patches, place, &mut line_murk));
            }
            let to = y * STEP..(y + 1) * STEP;
            for (all, own) in [
                (&mut rays.right, &line.right),
                (&mut rays.down, &line.down),
                (&mut rays.ahead, &line.ahead),
                (&mut rays.end, &line.end),
                (&mut murk.source, &line_murk.source),
                (&mut murk.path, &line_murk.path),
                (&mut murk.stretch, &line_murk.stretch),
            ] {
                all[to.clone()].copy_from_slice(&own[..STEP]);
            }
        }
        let (intervals, span) = vectorized!(whole(lamp, &rays, &murk));
        if span.to <= span.from {
            return errors;
        }
        let sum = match lamp.fixed {
            Some(count) => self.at_fixed(&intervals, count),
            None => composite::sum_up::<true>(lamp, &intervals, self.spacing()),
        };
        let mut most = [0.0f32; RUN];
        for (channel, light) in sum.light.iter().enumerate() {
            for i in 0..RUN {
                let (x, y) = at(i);
                if x < width && y < height {
                    glow[channel][y * width + x] += light[i];
                    most[i] = most[i].max(light[i]);
                }
            }
        }
        errors.left = sum.left;
        errors.rounding = lamp.rounding.within(span, extreme(&most, f32::max));
        errors
    }
}

#[inline(always)]
fn whole(lamp: &Glow, rays: &Rays, murk: &Murk) -> (Intervals, nodes::Span) {
    intervals::<true, true>(lamp, rays, murk)
}

/// So many halves of the intervals from where they begin, in β.
#[inline(always)]
fn angles_of(to: &Intervals, halves: f32, angles: &mut Lanes) {
    for i in 0..RUN {
        angles[i] = halves.mul_add(to.half[i], to.from[i]).min(FRAC_PI_2);
    }
}
