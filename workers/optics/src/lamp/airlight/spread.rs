//! Airlight of lamps with multiple scattering: S e^{−c L} + S̄ (e^{−c_g L} − e^{−c L}) along the whole ray.
//!
//! It changes little from pixel to pixel except with range, and S̄ is the most expensive part of a node. So the sums from the
//! camera to the end of each cell are computed along the rays of every 16th pixel only, and interpolated between them at the range
//! of each pixel. The error is estimated from the differences between the rays in the cells of the pixels' ends. If it is too
//! large, the spacing of rays is halved, down to every second pixel; pixels that still fail are integrated separately.

mod bends;
mod beside;
mod blocks;
mod ends;
mod line;
mod murkiness;
mod read;

use std::f32::consts::FRAC_PI_2;

use imaging::{Plane, vectorized};

use super::super::nodes;
use super::composite::{self, Sum};
use super::integrand::SpreadNode;
use super::intervals::{Intervals, Murk, Rays, extreme, intervals};
use super::{Errors, Glow, Lanes, Order, RUN};
use crate::error_bound::ErrorBound;
use crate::lamp::{Lamp, Lighting};
use crate::turbidity;
use bends::ACROSS;
use ends::Ends;
use line::Line;
use murkiness::Murkiness;
use read::Band;

/// First spacing of rays in columns and rows; the least spacing; and the largest spacing with rays for several degrees of
/// turbidity.
const STEP: usize = 16;
const FINEST: usize = 2;
const FINEST_IN_DEGREES: usize = 4;
/// Rows of rays in one integration.
const LINES: i64 = 5;
/// How many equal cells a ray may be cut into.
const CELLS: [usize; 4] = [16, 32, 64, 128];
/// A number of cells is enough if its error on the rays of two rows is within this share of the tolerance: other rows may have
/// more.
const LEFT_BY_CELLS: f64 = 0.6;
/// Share of the tolerance for interpolation between rays; the rest is for rounding in f32.
const READ: f64 = 0.8;
/// Ratio of the interpolation error to the second differences between rays or their changes, whichever is less, and to the third
/// differences of the slope along a ray and its changes about the cell. Next to a cone light rises as d^1.5 with an error of 0.24
/// of such changes, smooth light has 0.07. A kink of the light would have 0.5: that needs a ray within the radius of a lamp, whose
/// airlight is so steep there that its rays never agree.
const BETWEEN_RAYS: f32 = 0.4;
const BETWEEN_RAYS_BENT: f32 = 0.3;
const BETWEEN_CELLS: f32 = 0.2;
const WITHIN_CELL: f32 = 0.2;
/// Estimated error of a parabola per third difference between degrees of turbidity; the actual one is at most 0.064.
const BETWEEN_DEGREES: f32 = 0.2;
/// Limit of the angle between the directions to the lamp from two rays, as a share of its cone: a narrow beam might pass between
/// them.
const SHARE_OF_CONE: f32 = 0.125;
/// The cone of a point lamp in radians.
const OPEN: f32 = 1.0;
/// Largest spacing of nodes along a ray as a share of the cone, in β.
const NODES_OF_CONE: f32 = 0.35;

/// Adds the light of a lamp with multiple scattering. `room` is scratch memory.
pub(super) fn add(
    range: &Plane<f32>,
    (lamp, lighting): (&Lamp, &Lighting),
    (rules, order): (&[Vec<[f32; 2]>], Order),
    (glow, room): (&mut [Vec<f32>; 3], &mut Vec<f32>),
) -> Errors {
    let camera = &lighting.camera;
    // A separately integrated pixel has two sums of a spot.
    let each = match order {
        Order::Within(tolerance) if lamp.is_spot() => Order::Within(ErrorBound {
            absolute: 0.5 * tolerance.absolute,
            ..tolerance
        }),
        order => order,
    };
    let spread = Glow::spread(lamp, lighting, each);
    let direct = Glow::new(lamp, lighting, each);
    let is_dark = direct.source.strength <= 0.0;
    let mut frame = Frame {
        range,
        lens: [1.0 / camera.focal_px, camera.cx, camera.cy].map(|v| v as f32),
        patches: (lighting.patches.as_ref()).map(|field| turbidity::Rays::new(field, camera)),
        murkiness: Murkiness::Even,
        lamp: spread.as_ref().unwrap_or(&direct),
        direct: &direct,
        tolerance: READ * order.tolerance().absolute,
        tolerated_share: order.tolerance().relative as f32,
        cut: Cut {
            cells: 0,
            first: 0,
            used: 0,
        },
        rules,
    };
    if is_dark {
        return Errors::default();
    }
    let Some(ends) = frame.cut(room) else {
        return frame.sum_up_all(glow);
    };
    frame.read_all(&ends, glow)
}

/// Equal cells of a ray, and those needed by a pixel: earlier ones are integrated, but not stored.
#[derive(Clone, Copy)]
struct Cut {
    cells: usize,
    first: usize,
    used: usize,
}

/// Number of rays across these blocks, in pairs, with one before and one behind.
fn rays_across(blocks: usize) -> usize {
    blocks.next_multiple_of(2) + ACROSS - 2
}

/// The frame and lamp of one call of [`add`].
struct Frame<'a> {
    range: &'a Plane<f32>,
    lens: [f32; 3],
    patches: Option<turbidity::Rays>,
    murkiness: Murkiness,
    /// Light for interpolation between rays.
    lamp: &'a Glow,
    /// Unscattered light; all light of a point lamp.
    direct: &'a Glow,
    /// Tolerance of the interpolated light, and the share of it that it may err by in addition.
    tolerance: f64,
    tolerated_share: f32,
    cut: Cut,
    rules: &'a [Vec<[f32; 2]>],
}

impl Frame<'_> {
    /// Chooses the cells of rays; `None` if the light needs narrower ones than allowed.
    fn cut<'e>(&mut self, room: &'e mut Vec<f32>) -> Option<Ends<'e>> {
        // In β, a cell is at most twice as wide as in w.
        let spacing = self.spacing();
        let wide = CELLS
            .iter()
            .filter(|&&cells| 1.0 > spacing * cells as f32)
            .count();
        if wide == CELLS.len() || self.lamp.fixed.is_some() {
            return None;
        }
        self.murkiness = Murkiness::met(self);
        let ends = Ends::new(self, matches!(self.murkiness, Murkiness::Own), room);
        let (width, height) = self.range.size();
        let rays = vec![true; rays_across(width.div_ceil(STEP))];
        let rows = height.div_ceil(STEP) as i64;
        for &cells in &CELLS[wide..] {
            let read = ends.cells(cells);
            // With one on either side, into which slopes change.
            let (first, used) = (read.0.saturating_sub(1), (read.1 + 2).min(cells));
            self.cut = Cut { cells, first, used };
            let is_enough = [rows / 4, rows * 3 / 4].into_iter().all(|row| {
                let lines = Line::of_rows(self, (STEP, row..row + 1), self.cut, &rays);
                lines[0].left_by_cells(read, self.tolerated_share) <= LEFT_BY_CELLS * self.tolerance
            });
            if is_enough {
                break;
            }
        }
        Some(ends)
    }

    /// Interpolates all pixels between rays whose error estimate is within the tolerance.
    fn read_all(&self, ends: &Ends<'_>, glow: &mut [Vec<f32>; 3]) -> Errors {
        let (width, height) = self.range.size();
        let columns = width.div_ceil(STEP);
        let (rays, blocks) = (vec![true; rays_across(columns)], vec![true; columns]);
        // Rays of one pair of rows of blocks and the next, with one beyond each.
        let rows = height.div_ceil(STEP);
        let (mut lines, mut next) = (Vec::new(), -1);
        let (mut band, mut worst) = (Band::new(ends, glow, width), Errors::default());
        for row in 0..rows {
            if row > 0 && row % 2 == 0 {
                lines.drain(..2);
            }
            if lines.len() < ACROSS {
                let end = (next + LINES).min(rays_across(rows) as i64 - 1);
                lines.extend(Line::of_rows(self, (STEP, next..end), self.cut, &rays));
                next = end;
            }
            band.start();
            worst.include(self.fill(&mut band, &lines[..ACROSS], (STEP, row), &blocks));
            if let Murkiness::Own = self.murkiness {
                let pixels = row * STEP * width..height.min((row + 1) * STEP) * width;
                let alone: Vec<usize> = pixels.filter(|&pixel| ends.places[pixel] < 0.0).collect();
                worst.include(self.sum_up_each(&mut band, &alone));
            }
            worst.include(Errors {
                left: composite::LEAST,
                rounding: self.rounding(&band, row, &lines[..ACROSS]),
            });
        }
        worst
    }

    /// Rounding of f32 in the interpolated light of a band of rows between these lines of rays.
    fn rounding(&self, band: &Band<'_>, row: usize, lines: &[Line]) -> f64 {
        let murk = self.murkiness.span().unwrap_or_else(|| {
            let mut all = nodes::Span::dark();
            lines.iter().for_each(|line| all.join(&line.murk));
            all
        });
        let runs = band.most.len();
        let within = band.most.iter().enumerate().map(|(run, &most)| {
            let span = band.ends.span(row * runs + run, &murk);
            self.lamp.rounding.within(span, most)
        });
        within.fold(0.0, f64::max) + band.rounding(self.cut.cells)
    }

    /// Sums up along the ray of every pixel.
    fn sum_up_all(&self, glow: &mut [Vec<f32>; 3]) -> Errors {
        let (width, height) = self.range.size();
        let mut worst = Errors::default();
        for first in (0..width * height).step_by(RUN) {
            let pixels: Vec<usize> = (first..(first + RUN).min(width * height)).collect();
            let (light, errors) = self.sum_up(&pixels);
            worst.include(errors);
            for (glow, light) in glow.iter_mut().zip(&light) {
                for (i, &at) in pixels.iter().enumerate() {
                    glow[at] += light[i];
                }
            }
        }
        worst
    }

    /// Upper bound of the turn of the direction to the lamp between rays `step` pixels apart, as a share of its cone.
    fn turn(&self, step: usize, nearest_m: f32) -> f32 {
        let [x, y, z] = self.lamp.place;
        let away = x.mul_add(x, y.mul_add(y, z * z)).sqrt();
        let turned = step as f32 * self.lens[0] * (away / nearest_m).max(1.0);
        turned / self.cone().unwrap_or(OPEN)
    }

    /// Largest spacing of nodes in β: several in each width of the lamp's profile.
    fn spacing(&self) -> f32 {
        let of_cone = NODES_OF_CONE * self.cone().unwrap_or(f32::INFINITY);
        of_cone.min(composite::spacing(self.lamp.source.phase.asymmetry))
    }

    /// The cone of a spot in radians.
    fn cone(&self) -> Option<f32> {
        let profile = &self.lamp.profile;
        (profile.slope > 0.0).then_some(profile.cone)
    }

    /// Sums up along the rays of some pixels, at most a run.
    fn sum_up(&self, pixels: &[usize]) -> ([Lanes; 3], Errors) {
        let (lamp, width) = (self.lamp, self.range.width());
        let mut rays = Rays::default();
        for (i, &at) in pixels.iter().enumerate() {
            let place = ((at % width) as f32, (at / width) as f32);
            rays.aim(self.lens, i, place, self.range.data()[at]);
        }
        let murk = self.murk_along(&rays);
        let (direct, rules) = (self.direct, self.rules);
        let (mut light, mut errors) = ([[0.0f32; RUN]; 3], Errors::default());
        if lamp.profile.slope == 0.0 {
            vectorized!(super::add::<false, true, true>(
                direct,
                &rays,
                &murk,
                (rules, &mut light, &mut errors)
            ));
            return (light, errors);
        }
        vectorized!(super::add::<true, false, true>(
            direct,
            &rays,
            &murk,
            (rules, &mut light, &mut errors)
        ));
        let (intervals, span) = vectorized!(whole(lamp, &rays, &murk));
        if span.to <= span.from {
            return (light, errors);
        }
        let sum = match lamp.fixed {
            Some(count) => self.at_fixed(&intervals, count),
            None => composite::sum_up::<true>(lamp, &intervals, self.spacing()),
        };
        let mut most = [0.0f32; RUN];
        for (light, spread) in light.iter_mut().zip(&sum.light) {
            for i in 0..RUN {
                light[i] += spread[i];
                most[i] = most[i].max(spread[i]);
            }
        }
        errors.left += sum.left;
        errors.rounding += lamp.rounding.within(span, extreme(&most, f32::max));
        (light, errors)
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

/// Angle β after `halves` halves of the intervals from their starts.
#[inline(always)]
fn angles_of(to: &Intervals, halves: f32, angles: &mut Lanes) {
    for i in 0..RUN {
        angles[i] = halves.mul_add(to.half[i], to.from[i]).min(FRAC_PI_2);
    }
}
