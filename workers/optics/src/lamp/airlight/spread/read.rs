//! Spread light of pixels, read between the rays about them.

use std::f32::consts::FRAC_PI_2;

use imaging::simd::larger;
use imaging::vectorized;

use super::super::intervals::{Intervals, Murk, Rays, intervals, rays_of};
use super::super::{Glow, Lanes, RUN};
use super::line::{Cell, Line};
use super::{Frame, STEP, nodes};

/// What f32 may lose of the place in a ray, as a share of it.
const PLACE: f64 = 1e-6;

/// The light of a lamp on the rows of pixels of a row of blocks.
pub(super) struct Band {
    /// The first pixel in the frame.
    first: usize,
    cells: usize,
    /// Where in its cells each pixel's ray ends.
    places: Vec<f32>,
    /// Three channels; the fourth fills a vector.
    light: Vec<[f32; 4]>,
    /// Of each run of each row.
    spans: Vec<nodes::Span>,
    /// The most light in a cell that is read.
    steepest: f32,
}

impl Band {
    pub(super) fn new(cells: usize) -> Self {
        Self {
            first: 0,
            cells,
            places: Vec::new(),
            light: Vec::new(),
            spans: Vec::new(),
            steepest: 0.0,
        }
    }

    /// Equal angles of a ray.
    pub(super) fn cells(&self) -> usize {
        self.cells
    }

    /// Sets the light of a pixel of the frame.
    pub(super) fn set(&mut self, pixel: usize, [red, green, blue]: [f32; 3]) {
        self.light[pixel - self.first] = [red, green, blue, 0.0];
    }
}

/// A block of pixels between four rays, those above first, of each degree of murkiness.
struct Block<'a> {
    corners: Vec<[&'a [Cell]; 4]>,
    /// Its columns, rows and side.
    xs: std::ops::Range<usize>,
    ys: std::ops::Range<usize>,
    step: usize,
}

impl Frame<'_> {
    /// Turns to the rows of pixels from `top` on.
    pub(super) fn start(&self, band: &mut Band, top: usize) {
        let (width, height) = self.range.size();
        let rows = top..height.min(top + STEP);
        band.first = top * width;
        band.places.clear();
        band.spans.clear();
        band.light.resize(rows.len() * width, [0.0; 4]);
        band.steepest = 0.0;
        for (y, x) in rows.flat_map(|y| (0..width).step_by(RUN).map(move |x| (y, x))) {
            let run = RUN.min(width - x);
            let first = y * width + x;
            let mut range_m = [f32::INFINITY; RUN];
            range_m[..run].copy_from_slice(&self.range.row(y)[x..x + run]);
            let mut rays = Rays::default();
            vectorized!(rays_of(self.lens, (x, y), &range_m, &mut rays));
            let murk = self.murkiness.of(first..first + run);
            let mut places = [0.0f32; RUN];
            let cells = band.cells as f32;
            let span = vectorized!(places_of(self.lamp, (&rays, &murk), cells, &mut places));
            band.places.extend_from_slice(&places[..run]);
            band.spans.push(span);
        }
    }

    /// Reads the light of a block between two lines of rays.
    pub(super) fn read(
        &self,
        band: &mut Band,
        [top, bottom]: [&Line; 2],
        (step, row): (usize, usize),
        column: usize,
    ) {
        let (xs, ys) = self.pixels(step, (column, row));
        let above = top.ray(column + 1).zip(top.ray(column + 2));
        let below = bottom.ray(column + 1).zip(bottom.ray(column + 2));
        let block = Block {
            corners: above.zip(below).map(|((a, b), (c, d))| [a, b, c, d]).collect(),
            xs,
            ys,
            step,
        };
        vectorized!(self.read_block(band, &block));
    }

    #[inline(always)]
    fn read_block(&self, band: &mut Band, block: &Block<'_>) {
        let width = self.range.width();
        let last = band.cells - 1;
        let inverse = 1.0 / block.step as f32;
        let (x_0, y_0) = (block.xs.start, block.ys.start);
        let mut steepest = [band.steepest; 4];
        for y in block.ys.clone() {
            let down = (y - y_0) as f32 * inverse;
            let first = y * width + x_0;
            let own = first - band.first..first - band.first + block.xs.len();
            let pixels = band.light[own.clone()].iter_mut().zip(&band.places[own]);
            for (x, (light, &place)) in pixels.enumerate() {
                let right = x as f32 * inverse;
                let cell = (place as usize).min(last);
                let u = place - cell as f32;
                let (source, degree, weights) = self.murkiness.weights(first + x);
                let mut sum = [0.0f32; 4];
                for (corners, weight) in block.corners[degree..].iter().zip(weights) {
                    let four = corners.map(|ray| &ray[cell]);
                    let light = between(four, u, [right, down]);
                    for i in 0..4 {
                        sum[i] = weight.mul_add(light[i], sum[i]);
                        let inside = source * larger(four[0][1][i], four[3][1][i]);
                        steepest[i] = larger(inside, steepest[i]);
                    }
                }
                for i in 0..4 {
                    light[i] = source * larger(sum[i], 0.0);
                }
            }
        }
        band.steepest = steepest.into_iter().fold(0.0, f32::max);
    }

    /// Adds a band to the frame. Returns what f32 may have lost.
    pub(super) fn finish(&self, band: &Band, glow: &mut [Vec<f32>; 3]) -> f64 {
        let width = self.range.width();
        let runs = (0..band.places.len() / width).flat_map(|row| {
            let starts = (0..width).step_by(RUN);
            starts.map(move |x| row * width + x..row * width + width.min(x + RUN))
        });
        let [red, green, blue] = glow.each_mut().map(|plane| &mut plane[band.first..]);
        let mut rounding = 0.0f64;
        for (run, span) in runs.zip(&band.spans) {
            let mut to = [&mut *red, green, blue].map(|plane| &mut plane[run.clone()]);
            let most = vectorized!(add(&band.light[run.clone()], &mut to));
            if most > 0.0 {
                rounding = rounding.max(self.lamp.rounding.within(*span, most));
            }
        }
        rounding + PLACE * band.cells as f64 * f64::from(band.steepest)
    }
}

/// Adds the light of a run to the frame. Returns the most of a channel.
#[inline(always)]
fn add(light: &[[f32; 4]], [red, green, blue]: &mut [&mut [f32]; 3]) -> f32 {
    let mut most = [0.0f32; 4];
    for (((light, red), green), blue) in light
        .iter()
        .zip(red.iter_mut())
        .zip(green.iter_mut())
        .zip(blue.iter_mut())
    {
        for i in 0..4 {
            most[i] = larger(light[i], most[i]);
        }
        (*red, *green, *blue) = (*red + light[0], *green + light[1], *blue + light[2]);
    }
    most.into_iter().fold(0.0, f32::max)
}

/// Where in its cells each ray ends.
#[inline(always)]
fn places_of(lamp: &Glow, (rays, murk): (&Rays, &Murk), cells: f32, places: &mut Lanes) -> nodes::Span {
    let (Intervals { half, from, .. }, span) = intervals::<false, true>(lamp, rays, murk);
    for i in 0..RUN {
        let whole = FRAC_PI_2 - from[i];
        places[i] = (2.0 * cells * half[i] / whole).min(cells);
    }
    span
}

/// The sum up to a place in a cell, between the cells of four rays.
#[inline(always)]
fn between(four: [&Cell; 4], u: f32, [right, down]: [f32; 2]) -> [f32; 4] {
    let [a, b, c, d] = four.map(|[start, inside, slope]| {
        let mut at = [0.0f32; 4];
        for i in 0..4 {
            at[i] = u.mul_add(slope[i].mul_add(u - 1.0, inside[i]), start[i]);
        }
        at
    });
    let mut light = [0.0f32; 4];
    for i in 0..4 {
        let (top, bottom) = (right.mul_add(b[i] - a[i], a[i]), right.mul_add(d[i] - c[i], c[i]));
        light[i] = down.mul_add(bottom - top, top);
    }
    light
}
