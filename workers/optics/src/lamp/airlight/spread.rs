//! The glow of light from a spot that was spread on its way: S̄ (e^{−c_g L} − e^{−c L}) along the whole ray, in its cone or not.
//!
//! It changes little from pixel to pixel but with the range, and S̄ costs more than all else of a node. So its sum from the camera up
//! to each of some equal angles is taken along the rays of every 16th pixel only, and read between them at the angle that a pixel's
//! own range ends at. What that may leave is seen from the second differences between the rays; where it is too much, rays lie
//! half as far apart, down to every second pixel, and where they still do, pixels are summed up each by itself. In patches the
//! sums are taken at a few degrees of murkiness.

mod blocks;
mod line;
mod murkiness;
mod read;

use std::f32::consts::FRAC_PI_2;

use imaging::{Plane, vectorized};

use super::super::nodes;
use super::composite::{self, Sum};
use super::integrand::SpreadNode;
use super::intervals::{Intervals, Murk, Rays, extreme, intervals};
use super::{Errors, Glow, Lanes, RUN};
use crate::lamp::Lighting;
use crate::turbidity;
use line::Line;
use murkiness::Murkiness;
use read::Band;

/// Every such column and row has a ray at first; the least distance that is tried, and in patches, where each ray takes the time
/// of several.
const STEP: usize = 16;
const FINEST: usize = 2;
const FINEST_IN_PATCHES: usize = 4;
/// How many equal angles a ray may be cut into.
const CELLS: [usize; 3] = [32, 64, 128];
/// By this the second differences between rays, and the changes of slope from cell to cell, exceed the error.
const BETWEEN_RAYS: f32 = 0.4;
const BETWEEN_CELLS: f32 = 0.2;
/// Third differences between degrees of murkiness exceed the error of a parabola, at most 0.064 of them, by this.
const BETWEEN_DEGREES: f32 = 0.2;
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
    frame.murkiness = Murkiness::met(&frame);
    let spacing = frame.spacing();
    let cells = (CELLS.into_iter()).find(|&cells| FRAC_PI_2 <= spacing * (2 * cells) as f32);
    match cells.filter(|_| lamp.fixed.is_none()) {
        Some(cells) => frame.read_all(cells, glow),
        None => frame.sum_up_all(glow),
    }
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
    /// Reads all pixels between rays of so many cells, as far as that may be.
    fn read_all(&self, cells: usize, glow: &mut [Vec<f32>; 3]) -> Errors {
        let (width, height) = self.range.size();
        let columns = width.div_ceil(STEP);
        let line = |row: i64| Line::new(self, (STEP, row), cells, &vec![true; columns + 3]);
        // Rays of one row of blocks and the next, with one beyond each.
        let mut lines: [Line; 4] = std::array::from_fn(|i| line(i as i64 - 1));
        let (mut band, mut errors) = (Band::new(cells), Errors::default());
        for row in 0..height.div_ceil(STEP) {
            self.start(&mut band, row * STEP);
            let left = self.fill(&mut band, &lines, (STEP, row), &vec![true; columns]);
            let rounding = self.finish(&band, glow);
            errors.include(Errors { left, rounding });
            lines.rotate_left(1);
            lines[3] = line(row as i64 + 3);
        }
        errors
    }

    /// Sums up along the ray of every pixel.
    fn sum_up_all(&self, glow: &mut [Vec<f32>; 3]) -> Errors {
        let (width, height) = self.range.size();
        let mut errors = Errors::default();
        for first in (0..width * height).step_by(RUN) {
            let pixels: Vec<usize> = (first..(first + RUN).min(width * height)).collect();
            let (sum, span) = self.sum_up(&pixels);
            let mut most = [0.0f32; RUN];
            for (glow, light) in glow.iter_mut().zip(&sum.light) {
                for (i, &at) in pixels.iter().enumerate() {
                    glow[at] += light[i];
                    most[i] = most[i].max(light[i]);
                }
            }
            if span.to > span.from {
                errors.include(Errors {
                    left: sum.left,
                    rounding: self.lamp.rounding.within(span, extreme(&most, f32::max)),
                });
            }
        }
        errors
    }

    /// By which share of its cone the direction to the lamp turns at most between rays so many pixels apart.
    fn turn(&self, step: usize, nearest_m: f32) -> f32 {
        let [x, y, z] = self.lamp.place;
        let away = x.mul_add(x, y.mul_add(y, z * z)).sqrt();
        let turned = step as f32 * self.lens[0] * (away / nearest_m).max(1.0);
        turned / self.lamp.profile.cos_cone.acos()
    }

    /// How far apart nodes in β may lie: some in each of the widths that the profile of the lamp changes over.
    fn spacing(&self) -> f32 {
        let of_cone = NODES_OF_CONE * self.lamp.profile.cos_cone.acos();
        of_cone.min(composite::spacing(self.lamp.source.asymmetry))
    }

    /// Sums up along the rays of some pixels, at most a run.
    fn sum_up(&self, pixels: &[usize]) -> (Sum, nodes::Span) {
        let (lamp, width) = (self.lamp, self.range.width());
        let mut rays = Rays::default();
        for (i, &at) in pixels.iter().enumerate() {
            let place = ((at % width) as f32, (at / width) as f32);
            rays.aim(self.lens, i, place, self.range.data()[at]);
        }
        let murk = self.murkiness.of(pixels.iter().copied());
        let (intervals, span) = vectorized!(whole(lamp, &rays, &murk));
        let sum = match lamp.fixed {
            _ if span.to <= span.from => Sum {
                light: [[0.0; RUN]; 3],
                left: 0.0,
            },
            Some(count) => self.at_fixed(&intervals, count),
            None => composite::sum_up::<true>(lamp, &intervals, self.spacing()),
        };
        (sum, span)
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
