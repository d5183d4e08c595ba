//! Light of pixels, interpolated between the rays about them.

use std::ops::Range;

use imaging::simd::larger;
use imaging::vectorized;

use super::bends::{Bend, Place};
use super::ends::{BY_ITSELF, Ends};
use super::line::{INSIDE, Ray, SLOPE};
use super::murkiness::{Degrees, Murkiness};
use super::{Frame, RUN, STEP};

/// Rounding of f32 in the position on a ray, as a share of it.
const PLACE: f64 = 1e-6;

type Block16 = [f32; STEP];

/// The light of a lamp on the pixels of a band of rows.
pub(super) struct Band<'a> {
    pub(super) ends: &'a Ends<'a>,
    glow: [&'a mut [f32]; 3],
    /// The most light of each run of columns.
    pub(super) most: Vec<f32>,
    /// The most light in an interpolated cell.
    steepest: f32,
}

impl<'a> Band<'a> {
    /// Of a frame of this width.
    pub(super) fn new(ends: &'a Ends<'a>, glow: &'a mut [Vec<f32>; 3], width: usize) -> Self {
        Self {
            ends,
            glow: glow.each_mut().map(Vec::as_mut_slice),
            most: vec![0.0; width.div_ceil(RUN)],
            steepest: 0.0,
        }
    }

    /// Turns to the next band.
    pub(super) fn start(&mut self) {
        self.most.fill(0.0);
        self.steepest = 0.0;
    }

    /// Adds to the light of a pixel of the frame.
    pub(super) fn add(&mut self, pixel: usize, width: usize, light: [f32; 3]) {
        let most = &mut self.most[pixel % width / RUN];
        for (glow, light) in self.glow.iter_mut().zip(light) {
            glow[pixel] += light;
            *most = most.max(light);
        }
    }

    /// Rounding of f32 between rays with this number of cells.
    pub(super) fn rounding(&self, cells: usize) -> f64 {
        PLACE * cells as f64 * f64::from(self.steepest)
    }
}

/// A block of pixels between four rays, those above first, of each degree of turbidity.
pub(super) struct Block<'a> {
    corners: Vec<[Ray<'a>; 4]>,
    /// Cell of the first of `bends`, which is empty for linear interpolation.
    first: usize,
    bends: Vec<Bend>,
    /// Its columns.
    xs: Range<usize>,
    most: Block16,
}

impl<'a> Block<'a> {
    pub(super) fn new(place: Place<'a>, (first, bends): (usize, Vec<Bend>), xs: Range<usize>) -> Self {
        let ([top, bottom], [left, right]) = (place.beside(), place.rays());
        let above = top.ray(left).zip(top.ray(right));
        let below = bottom.ray(left).zip(bottom.ray(right));
        Self {
            corners: above.zip(below).map(|((a, b), (c, d))| [a, b, c, d]).collect(),
            first,
            bends,
            xs,
            most: [0.0; STEP],
        }
    }
}

impl Frame<'_> {
    /// Interpolates the light of some blocks of a row, row by row of pixels, in the order of memory.
    pub(super) fn read(
        &self,
        band: &mut Band<'_>,
        blocks: &mut [Block<'_>],
        (step, ys): (usize, Range<usize>),
    ) {
        let to = (self.range.width(), self.cut.cells);
        let first = ys.start;
        for y in ys {
            let (down, step) = ((y - first) as f32 / step as f32, step as f32);
            match &self.murkiness {
                Murkiness::Even | Murkiness::Own => {
                    vectorized!(read_rows(band, blocks, (y, down, step), to));
                }
                Murkiness::Degrees(degrees) => {
                    vectorized!(read_degrees(band, blocks, (y, down, step), to, degrees));
                }
            }
        }
        for block in blocks {
            let of_run = &mut band.most[block.xs.start / RUN];
            *of_run = block.most.iter().copied().fold(*of_run, f32::max);
        }
    }
}

#[inline(always)]
fn read_rows(
    band: &mut Band<'_>,
    blocks: &mut [Block<'_>],
    (y, down, step): (usize, f32, f32),
    (width, cells): (usize, usize),
) {
    let mut right = [0.0f32; STEP];
    for x in 0..STEP {
        right[x] = x as f32 / step;
    }
    let mut steepest = [band.steepest; 16];
    for block in blocks {
        let own = y * width + block.xs.start..y * width + block.xs.end;
        let mut places = lanes(&band.ends.places[own.clone()], BY_ITSELF);
        for place in &mut places {
            *place *= cells as f32;
        }
        let light = read_row(block, (&places, &right, down), cells - 1, &mut steepest);
        for (plane, light) in band.glow.iter_mut().zip(&light) {
            let glow = &mut plane[own.clone()];
            let mut sum = lanes(glow, 0.0);
            for x in 0..STEP {
                block.most[x] = larger(light[x], block.most[x]);
                sum[x] += light[x];
            }
            match <&mut Block16>::try_from(&mut *glow) {
                Ok(glow) => *glow = sum,
                Err(_) => glow.copy_from_slice(&sum[..own.len()]),
            }
        }
    }
    for i in INSIDE..INSIDE + 3 {
        band.steepest = larger(steepest[i], band.steepest);
    }
}

/// A row of a block, filled up.
#[inline(always)]
pub(super) fn lanes(row: &[f32], rest: f32) -> Block16 {
    if let Ok(whole) = <&Block16>::try_from(row) {
        return *whole;
    }
    let mut lanes = [rest; STEP];
    lanes[..row.len()].copy_from_slice(row);
    lanes
}

/// The light of a row of pixels; 0 for negative places. All lanes are computed in every end cell of a pixel.
#[inline(always)]
fn read_row(
    block: &Block<'_>,
    (places, right, down): (&Block16, &Block16, f32),
    last: usize,
    steepest: &mut [f32; 16],
) -> [Block16; 3] {
    let mut light = [[0.0f32; STEP]; 3];
    let mut cells = [0.0f32; STEP];
    for x in 0..STEP {
        let cell = places[x].floor();
        cells[x] = if cell > last as f32 { last as f32 } else { cell };
    }
    let bent_down = 0.5 * down * (down - 1.0);
    let mut bent = [0.0f32; STEP];
    for x in 0..STEP {
        bent[x] = 0.5 * right[x] * (right[x] - 1.0);
    }
    let is_one = block.bends.len() == 1;
    let mut cell = if is_one {
        block.first as f32
    } else {
        next(&cells, -1.0)
    };
    while cell <= last as f32 {
        let four = block.corners[0].each_ref().map(|ray| ray.at(cell as usize));
        let Bend {
            across: [above, below],
            down: [to_left, to_right],
        } = &block.bends[cell as usize - block.first];
        let [mut left, mut turn, mut bend] = [[0.0f32; 16]; 3];
        for i in 0..16 {
            let (a, b) = (four[0][i], four[1][i]);
            left[i] = bent_down.mul_add(to_left[i], down.mul_add(four[2][i] - a, a));
            turn[i] = bent_down.mul_add(to_right[i], down.mul_add(four[3][i] - b, b)) - left[i];
            bend[i] = down.mul_add(below[i] - above[i], above[i]);
            steepest[i] = larger(larger(a, four[3][i]), steepest[i]);
        }
        for channel in 0..3 {
            let [start, inside, slope] =
                [0, INSIDE, SLOPE].map(|part| [left, turn, bend].map(|lanes| lanes[part + channel]));
            for x in 0..STEP {
                let u = places[x] - cell;
                let slope = bent[x].mul_add(slope[2], right[x].mul_add(slope[1], slope[0]));
                let inside = bent[x].mul_add(inside[2], right[x].mul_add(inside[1], inside[0]));
                let sum = bent[x].mul_add(start[2], right[x].mul_add(start[1], start[0]));
                let sum = larger(u.mul_add(slope.mul_add(u - 1.0, inside), sum), 0.0);
                light[channel][x] = if cells[x] == cell { sum } else { light[channel][x] };
            }
        }
        cell = if is_one { f32::INFINITY } else { next(&cells, cell) };
    }
    light
}

/// The least of some cells above another.
#[inline(always)]
fn next(cells: &Block16, than: f32) -> f32 {
    let mut best = [f32::INFINITY; STEP];
    for x in 0..STEP {
        best[x] = if cells[x] > than { cells[x] } else { f32::INFINITY };
    }
    let mut half = STEP / 2;
    while half > 0 {
        for x in 0..half {
            best[x] = if best[x + half] < best[x] {
                best[x + half]
            } else {
                best[x]
            };
        }
        half /= 2;
    }
    best[0]
}

#[inline(always)]
fn read_degrees(
    band: &mut Band<'_>,
    blocks: &[Block<'_>],
    (y, down, step): (usize, f32, f32),
    (width, cells): (usize, usize),
    degrees: &Degrees,
) {
    for block in blocks {
        for x in block.xs.clone() {
            let pixel = y * width + x;
            let right = (x - block.xs.start) as f32 / step;
            let place = cells as f32 * band.ends.places[pixel];
            let cell = (place as usize).min(cells - 1);
            let u = place - cell as f32;
            let (source, degree, weights) = degrees.weights(pixel);
            let mut sum = [0.0f32; 4];
            for (corners, weight) in block.corners[degree..].iter().zip(weights) {
                let four = corners.map(|ray| *ray.at(cell));
                let light = between(four, u, [right, down]);
                for i in 0..4 {
                    sum[i] = weight.mul_add(light[i], sum[i]);
                    let inside = source * larger(four[0][INSIDE + i], four[3][INSIDE + i]);
                    band.steepest = larger(inside, band.steepest);
                }
            }
            band.add(pixel, width, [0, 1, 2].map(|i| source * larger(sum[i], 0.0)));
        }
    }
}

/// The sum up to a position in a cell, interpolated between the cells of four rays.
#[inline(always)]
fn between(four: [[f32; 16]; 4], u: f32, [right, down]: [f32; 2]) -> [f32; 4] {
    let [a, b, c, d] = four.map(|cell| {
        let mut at = [0.0f32; 4];
        for i in 0..4 {
            at[i] = u.mul_add(cell[SLOPE + i].mul_add(u - 1.0, cell[INSIDE + i]), cell[i]);
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
