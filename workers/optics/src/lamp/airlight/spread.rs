//! The glow of light from a spot that was spread on its way: S̄ (e^{−c_g L} − e^{−c L}) along the whole ray, in its cone or not.
//!
//! It changes little from pixel to pixel but with the range, and the 24 places of S̄ cost ten times as much as all else of a node.
//! So its sum from the camera up to each of 32 equal angles is taken along the rays of every eighth pixel only, and read between
//! them at the angle that a pixel's own range ends at. What that may leave is seen from the second differences between the rays;
//! where it is too much, and in patches, pixels are summed up each by itself.

use imaging::{Plane, vectorized};

use super::super::nodes;
use super::composite::{self, Sum};
use super::integrand::spread_at;
use super::intervals::{Intervals, Murk, Rays, extreme, intervals, murk_of, rays_of};
use super::{Errors, Glow, Lanes, RUN};
use crate::elementary::{sin_cos, small_sin_cos};
use crate::lamp::Lighting;
use crate::turbidity;

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
/// Between two rays the lamp is seen from directions no farther apart than this share of its cone: a narrow beam might pass between
/// them and be seen by neither.
const SHARE_OF_CONE: f32 = 0.125;
/// Along a ray, nodes lie at most this share of the cone apart, in β.
const NODES_OF_CONE: f32 = 0.35;
/// What f32 may lose of the place in a cell, in cells.
const PLACE: f64 = 3e-5;

/// Adds the light of a spot that was spread on its way.
pub(super) fn add(
    range: &Plane<f32>,
    lighting: &Lighting,
    lamp: &Glow,
    rules: &[Vec<[f32; 2]>],
    glow: &mut [Vec<f32>; 3],
) -> Errors {
    let camera = &lighting.camera;
    let frame = Frame {
        range,
        lens: [1.0 / camera.focal_px, camera.cx, camera.cy].map(|v| v as f32),
        patches: (lighting.patches.as_ref()).map(|field| turbidity::Rays::new(field, camera)),
        lamp,
        rules,
    };
    let (columns, rows) = (range.width().div_ceil(STEP), range.height().div_ceil(STEP));
    let mut errors = Errors::default();
    if frame.patches.is_some() || lamp.fixed.is_some() {
        for block in (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row))) {
            errors.include(frame.sum_up(block, glow));
        }
        return errors;
    }
    // Rays of one row of blocks and the next, with one beyond each.
    let mut strips: [Strip; 4] = std::array::from_fn(|i| frame.strip(i as i64 - 1, columns));
    for row in 0..rows {
        let left: Vec<f64> = strips[1].left(&strips[0], &strips[2]);
        let next = strips[2].left(&strips[1], &strips[3]);
        let worst = |column: usize| [left[column], left[column + 1], next[column], next[column + 1]];
        let worst: Vec<f64> = (0..columns)
            .map(|column| worst(column).into_iter().fold(0.0, f64::max))
            .collect();
        let nearest = |column: usize| {
            let ends = [column + 1, column + 2].map(|at| strips[1].distance[at].min(strips[2].distance[at]));
            ends[0].min(ends[1])
        };
        let is_read = |column: usize| {
            let is_wide = std::f32::consts::FRAC_PI_2 <= frame.spacing() * 2.0 * CELLS as f32;
            is_wide && worst[column] <= lamp.source.tolerance && frame.turn(nearest(column)) <= SHARE_OF_CONE
        };
        for column in (0..columns).filter(|&column| !is_read(column)) {
            errors.include(frame.sum_up((column, row), glow));
        }
        let read: Vec<bool> = (0..columns).map(is_read).collect();
        let rounding = frame.read([&strips[1], &strips[2]], row, &read, glow);
        let left = (0..columns)
            .filter(|&column| read[column])
            .map(|column| worst[column]);
        errors.include(Errors {
            left: left.fold(0.0, f64::max),
            rounding,
        });
        strips.rotate_left(1);
        strips[3] = frame.strip(row as i64 + 3, columns);
    }
    errors
}

/// What a spot is added to.
struct Frame<'a> {
    range: &'a Plane<f32>,
    lens: [f32; 3],
    patches: Option<turbidity::Rays>,
    lamp: &'a Glow,
    rules: &'a [Vec<[f32; 2]>],
}

/// The rays of every eighth pixel of a row, from one before the frame to one behind it: [`VALUES`] for each cell, and how far the
/// lamp is from the ray, m.
struct Strip {
    rays: Vec<[[f32; VALUES]; CELLS]>,
    distance: Vec<f32>,
}

impl Strip {
    /// What may be left between each of its rays within the frame and its neighbors.
    fn left(&self, above: &Self, below: &Self) -> Vec<f64> {
        let own = |at: usize| {
            let bend = |a: &[f32; VALUES], b: &[f32; VALUES], c: &[f32; VALUES], i: usize| {
                // Sums at the ends of the cells.
                let sum = |values: &[f32; VALUES]| values[i] + values[i + 3];
                (sum(a) - 2.0 * sum(b) + sum(c)).abs()
            };
            let mut worst = 0.0f32;
            let ray = &self.rays[at];
            for cell in 0..CELLS {
                let [left, right] = [&self.rays[at - 1][cell], &self.rays[at + 1][cell]];
                let [up, down] = [&above.rays[at][cell], &below.rays[at][cell]];
                for i in 0..3 {
                    let turn = if cell == 0 {
                        0.0
                    } else {
                        (ray[cell][i + 6] - ray[cell - 1][i + 6]).abs()
                    };
                    let rays = bend(left, &ray[cell], right, i) + bend(up, &ray[cell], down, i);
                    worst = worst.max(BETWEEN_RAYS as f32 * rays + BETWEEN_CELLS as f32 * turn);
                }
            }
            f64::from(worst)
        };
        (1..self.rays.len() - 1).map(own).collect()
    }
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
        for &node in &self.rules[count / 2] {
            vectorized!(at_nodes(lamp, intervals, node, &mut light));
        }
        for (light, gain) in light.iter_mut().zip(lamp.gain) {
            for i in 0..RUN {
                light[i] *= gain * intervals.scale[i];
            }
        }
        Sum { light, left: 0.0 }
    }

    /// The rays of a row of blocks; `columns` blocks have one ray more, and one on each side.
    fn strip(&self, row: i64, columns: usize) -> Strip {
        let [inverse_focal, cx, cy] = self.lens;
        let step = STEP as f32;
        // Its pixels are the rays, the first one block before the frame.
        let lens = [inverse_focal * step, cx / step + 1.0, cy / step - row as f32];
        let mut rays = vec![[[0.0f32; VALUES]; CELLS]; columns + 3];
        let mut distance = Vec::with_capacity(rays.len() + RUN);
        for (run, rays) in rays.chunks_mut(RUN).enumerate() {
            let mut directions = Rays::default();
            vectorized!(rays_of(
                lens,
                (run * RUN, 0),
                &[f32::INFINITY; RUN],
                &mut directions
            ));
            let murk = Murk::default();
            let (intervals, _) = vectorized!(whole(self.lamp, &directions, &murk));
            distance.extend(intervals.distance);
            let mut sums = [[0.0f32; RUN]; 3];
            for cell in 0..CELLS {
                let mut pair = [[[0.0f32; RUN]; 3]; 2];
                vectorized!(in_cell(self.lamp, &intervals, cell, &mut pair));
                for (i, ray) in rays.iter_mut().enumerate() {
                    let values = &mut ray[cell];
                    for channel in 0..3 {
                        let [first, second] = [pair[0][channel][i], pair[1][channel][i]];
                        values[channel] = sums[channel][i];
                        values[channel + 3] = first + second;
                        // Of a line through both nodes.
                        values[channel + 6] = (second - first) * SLOPE;
                        sums[channel][i] += first + second;
                    }
                }
            }
        }
        Strip { rays, distance }
    }

    /// Adds what is read between two strips to the pixels of a row of blocks. Returns what f32 may lose.
    fn read(&self, strips: [&Strip; 2], row: usize, read: &[bool], glow: &mut [Vec<f32>; 3]) -> f64 {
        let (width, height) = self.range.size();
        let mut rounding = 0.0f64;
        let mut between = strips[0].rays.clone();
        for y in row * STEP..height.min((row + 1) * STEP) {
            let share = (y - row * STEP) as f32 / STEP as f32;
            vectorized!(mix(
                strips[0].rays.as_flattened(),
                strips[1].rays.as_flattened(),
                share,
                between.as_flattened_mut()
            ));
            for start in (0..width).step_by(RUN) {
                let run = RUN.min(width - start);
                let mut range_m = [f32::INFINITY; RUN];
                range_m[..run].copy_from_slice(&self.range.row(y)[start..start + run]);
                let mut rays = Rays::default();
                vectorized!(rays_of(self.lens, (start, y), &range_m, &mut rays));
                let (intervals, span) = vectorized!(whole(self.lamp, &rays, &Murk::default()));
                let mut places = [0.0f32; RUN];
                vectorized!(places_of(&intervals, &mut places));
                let (mut most, mut steepest) = (0.0f32, 0.0f32);
                for i in (0..run).filter(|&i| read[(start + i) / STEP]) {
                    let x = start + i;
                    // The first ray lies before the frame.
                    let block = x / STEP + 1;
                    let share = (x % STEP) as f32 / STEP as f32;
                    let cell = (places[i] as usize).min(CELLS - 1);
                    let (a, b) = (&between[block][cell], &between[block + 1][cell]);
                    let u = places[i] - cell as f32;
                    for channel in 0..3 {
                        let at = |values: &[f32; VALUES]| {
                            values[channel] + u * (values[channel + 3] + values[channel + 6] * (u - 1.0))
                        };
                        let light = (at(a) + share * (at(b) - at(a))).max(0.0);
                        glow[channel][y * width + x] += light;
                        most = most.max(light);
                        steepest = steepest.max(a[channel + 3].max(b[channel + 3]));
                    }
                }
                let lost = self.lamp.rounding.within(span, most) + PLACE * f64::from(steepest);
                rounding = rounding.max(if most > 0.0 { lost } else { 0.0 });
            }
        }
        rounding
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

/// Half the distance of the two Gauss–Legendre nodes in a cell, in cells; and the slope of a line by what it rises between them.
const NODE: f32 = 0.288_675_13;
const SLOPE: f32 = 1.732_050_8;

#[inline(always)]
fn whole(lamp: &Glow, rays: &Rays, murk: &Murk) -> (Intervals, nodes::Span) {
    intervals::<true, true>(lamp, rays, murk)
}

/// The light of the two nodes of a cell.
#[inline(always)]
fn in_cell(lamp: &Glow, to: &Intervals, cell: usize, pair: &mut [[Lanes; 3]; 2]) {
    for (light, side) in pair.iter_mut().zip([-NODE, NODE]) {
        let share = (cell as f32 + 0.5 + side) * (2.0 / CELLS as f32);
        let [red, green, blue] = light;
        for i in 0..RUN {
            let angle = share
                .mul_add(to.half[i], to.from[i])
                .min(std::f32::consts::FRAC_PI_2);
            let [r, g, b] = spread_at(lamp, to, i, sin_cos(angle));
            let scale = to.scale[i] * (1.0 / CELLS as f32);
            red[i] = lamp.gain[0] * scale * r;
            green[i] = lamp.gain[1] * scale * g;
            blue[i] = lamp.gain[2] * scale * b;
        }
    }
}

/// Adds the two nodes `±node` of every pixel.
#[inline(always)]
fn at_nodes(lamp: &Glow, to: &Intervals, [node, weight]: [f32; 2], light: &mut [Lanes; 3]) {
    let [red, green, blue] = light;
    for i in 0..RUN {
        let (sin, cos) = (to.sin[i], to.cos[i]);
        let (sin_step, cos_step) = small_sin_cos(to.half[i] * node);
        let (ss, cc) = (sin * cos_step, cos * cos_step);
        let above = (cos.mul_add(sin_step, ss), (-sin).mul_add(sin_step, cc));
        let below = ((-cos).mul_add(sin_step, ss), sin.mul_add(sin_step, cc));
        let [r1, g1, b1] = spread_at(lamp, to, i, above);
        let [r2, g2, b2] = spread_at(lamp, to, i, below);
        red[i] = weight.mul_add(r1 + r2, red[i]);
        green[i] = weight.mul_add(g1 + g2, green[i]);
        blue[i] = weight.mul_add(b1 + b2, blue[i]);
    }
}

/// Where in its cells each ray ends.
#[inline(always)]
fn places_of(to: &Intervals, places: &mut Lanes) {
    for i in 0..RUN {
        let whole = std::f32::consts::FRAC_PI_2 - to.from[i];
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
