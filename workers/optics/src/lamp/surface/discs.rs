//! How much is seen from surfaces of the disc that scattered light of a lamp comes from. Such shadows are wide: the disc is looked
//! for from places a degree or two apart first, from more of them where what is seen changes, and from each at the edges of things.

use imaging::Plane;
use imaging::rays::Rays;
use imaging::simd::{larger, smaller};

use super::shade::{AWAY, IN_BEAM, LIT, off};
use crate::lamp::Lighting;
use crate::lamp::coarse::ALIKE;
use crate::lamp::multiple::surface_scale;
use crate::lamp::shadow::SPREAD_PLACES;
use crate::lamp::sight::{Disc, Radius, Sight, Starts};
use crate::lamp::tiles::in_tiles;

/// The most columns and rows of the cells whose corners are looked from first, and the angle that they may span, rad.
const STEP: usize = 8;
const ANGLE: f64 = 1.0 / 48.0;
/// Where the corners of a cell see shares of the disc that differ by no more, the others are read between them.
const READ_UP_TO: f32 = 0.25;
/// Where corners see more of the disc, but pixels between them less than half of the lamp itself, something small is in the way.
const OPEN: f32 = 0.9;
/// Channels that scatter no more than this many times as much as another share a disc. Its radius is within 12 % of theirs then, and
/// what is seen of it past a straight edge within 0.04: it changes by dR/(π R) at most.
const SHARED_UP_TO: f64 = 1.2;
/// Stands for what is seen from where nobody looked yet.
const UNKNOWN: f32 = -1.0;

/// What is seen of the discs of a lamp.
pub(super) struct Discs {
    /// Of the pixels of the frame: a share of all channels, or one of each.
    shares: Vec<Vec<f32>>,
    width: usize,
}

/// What the discs are looked for from.
#[derive(Clone, Copy)]
pub(super) struct Surfaces<'a> {
    pub(super) range: &'a Plane<f32>,
    pub(super) normals: &'a [Plane<f32>; 3],
    /// Of the pixels of the frame: how they stand to the lamp, and how much of the lamp itself is seen.
    pub(super) facing: &'a [f32],
    pub(super) seen: &'a [f32],
}

impl Discs {
    pub(super) fn new(lighting: &Lighting, lamp: [f32; 3], rays: &dyn Rays, surfaces: Surfaces<'_>) -> Self {
        let b = lighting.scattering;
        let (least, most) = b.into_iter().fold((f64::INFINITY, 0.0f64), |(least, most), b| {
            (least.min(b), most.max(b))
        });
        let of = |b: f64| Search::new(lighting, (lamp, b), rays, surfaces).shares();
        let shares = if most <= SHARED_UP_TO * least {
            vec![of((least * most).sqrt())]
        } else {
            let [small, large] = [of(least), of(most)];
            let between = |b: f64| {
                let part = ((b - least) / (most - least)) as f32;
                let both = small.iter().zip(&large);
                both.map(|(small, large)| small + part * (large - small))
                    .collect()
            };
            b.map(between).to_vec()
        };
        Self {
            shares,
            width: surfaces.range.width(),
        }
    }

    /// What is seen of the disc of each channel from row `y`.
    pub(super) fn of_row(&self, y: usize) -> [&[f32]; 3] {
        [0, 1, 2].map(|channel| {
            let of_frame = &self.shares[channel.min(self.shares.len() - 1)];
            &of_frame[y * self.width..(y + 1) * self.width]
        })
    }
}

/// Pixels whose corners are looked from: `step` columns and rows, fewer at the end of the frame.
#[derive(Clone, Copy)]
struct Cell {
    x: usize,
    y: usize,
    step: usize,
}

/// Looks for one disc.
struct Search<'a> {
    lighting: &'a Lighting,
    surfaces: Surfaces<'a>,
    lamp: [f32; 3],
    scattering: f64,
    disc: Disc,
    sight: Sight<'a>,
    /// Of the pixels of the frame.
    shares: Vec<f32>,
}

impl<'a> Search<'a> {
    fn new(
        lighting: &'a Lighting,
        (lamp, scattering): ([f32; 3], f64),
        rays: &'a dyn Rays,
        surfaces: Surfaces<'a>,
    ) -> Self {
        Self {
            lighting,
            surfaces,
            lamp,
            scattering,
            disc: Disc::new(SPREAD_PLACES),
            sight: Sight::new(rays),
            shares: vec![UNKNOWN; surfaces.facing.len()],
        }
    }

    fn shares(mut self) -> Vec<f32> {
        let (width, height) = self.surfaces.range.size();
        let mut step = STEP;
        while step > 1 && step as f64 > ANGLE * self.lighting.camera.focal_px {
            step /= 2;
        }
        let mut cells: Vec<Cell> = in_tiles(width.div_ceil(step), height.div_ceil(step))
            .map(|(column, row)| Cell {
                x: column * step,
                y: row * step,
                step,
            })
            .filter(|cell| self.is_open(*cell))
            .collect();
        while !cells.is_empty() {
            self.look_from_corners(&cells);
            let mut parts = Vec::new();
            for cell in cells.into_iter().filter(|cell| cell.step > 1) {
                if self.is_one(cell) {
                    self.read(cell);
                } else {
                    self.read_beside_edges(cell);
                    parts.extend(cell.quarters().filter(|part| self.is_open(*part)));
                }
            }
            cells = parts;
        }
        self.shares
    }

    /// The pixels of a cell, row by row.
    fn rows(&self, cell: Cell) -> impl Iterator<Item = std::ops::Range<usize>> + use<> {
        let (width, height) = self.surfaces.range.size();
        let columns = cell.x.min(width)..(cell.x + cell.step).min(width);
        let rows = cell.y..(cell.y + cell.step).min(height);
        rows.map(move |y| y * width + columns.start..y * width + columns.end)
    }

    /// Whether it is still to be found what is seen from a lit surface of a cell.
    fn is_open(&self, cell: Cell) -> bool {
        self.rows(cell).any(|row| {
            let facing = &self.surfaces.facing[row.clone()];
            let shares = &self.shares[row];
            (facing.iter().zip(shares)).any(|(facing, share)| *facing >= LIT && *share == UNKNOWN)
        })
    }

    /// The pixels at the corners of a cell; a single pixel has but one.
    fn corners(&self, Cell { x, y, step }: Cell) -> [usize; 4] {
        let (width, height) = self.surfaces.range.size();
        let step = if step == 1 { 0 } else { step };
        let (right, below) = ((x + step).min(width - 1), (y + step).min(height - 1));
        [(x, y), (right, y), (x, below), (right, below)].map(|(x, y)| y * width + x)
    }

    fn look_from_corners(&mut self, cells: &[Cell]) {
        let (mut pixels, mut starts, mut radii) = (Vec::new(), Starts::default(), Vec::new());
        for cell in cells {
            for at in self.corners(*cell) {
                if self.shares[at] == UNKNOWN && self.surfaces.facing[at] != AWAY {
                    // Not to be looked from again for the next cell.
                    self.shares[at] = 0.0;
                    let start = self.start(at);
                    let way = [0, 1, 2].map(|i| start[i] - self.lamp[i]);
                    let meters = way.map(|v| v * v).into_iter().sum::<f32>().sqrt();
                    pixels.push(at);
                    starts.push(start);
                    radii.push(meters * surface_scale(self.scattering * f64::from(meters)) as f32);
                }
            }
        }
        let mut found = Vec::new();
        let disc = (&self.disc, Radius::Of(&radii));
        self.sight.shares(&starts, self.lamp, disc, &mut found);
        for (&at, &share) in pixels.iter().zip(&found) {
            self.shares[at] = share;
        }
    }

    fn start(&self, at: usize) -> [f32; 3] {
        let Surfaces { range, normals, .. } = self.surfaces;
        let (x, y) = (at % range.width(), at / range.width());
        let ray = self.lighting.camera.ray(x as f64, y as f64);
        let meters = f64::from(range.data()[at]) / ray.length();
        let place = <[f64; 3]>::from(ray).map(|v| (v * meters) as f32);
        off(place, [0, 1, 2].map(|axis| normals[axis].data()[at]))
    }

    /// Whether a cell shows one surface, from whose corners much the same is seen of the disc, and the lamp itself where it is.
    fn is_one(&self, cell: Cell) -> bool {
        let Surfaces {
            range, facing, seen, ..
        } = self.surfaces;
        let corners = self.corners(cell);
        if corners.iter().any(|&at| facing[at] == AWAY) {
            return false;
        }
        let (least, most) = ends(corners.map(|at| self.shares[at]));
        if most - least > READ_UP_TO {
            return false;
        }
        let (mut nearest, mut farthest) = ends(corners.map(|at| range.data()[at]));
        let mut is_hidden = false;
        for row in self.rows(cell) {
            let (meters, facing, seen) = (&range.data()[row.clone()], &facing[row.clone()], &seen[row]);
            for ((&meters, &facing), &seen) in meters.iter().zip(facing).zip(seen) {
                // Without branches, so that several pixels are compared at once.
                let [near, far] = if facing >= LIT {
                    [meters; 2]
                } else {
                    [nearest, farthest]
                };
                (nearest, farthest) = (smaller(near, nearest), larger(far, farthest));
                is_hidden |= (facing == IN_BEAM) & (seen < 0.5);
            }
        }
        farthest <= ALIKE * nearest && !(is_hidden && least > OPEN)
    }

    /// Reads those pixels of a cell whose surface its corners show for the most part.
    fn read_beside_edges(&mut self, cell: Cell) {
        let corners = self.corners(cell);
        let Surfaces {
            range, facing, seen, ..
        } = self.surfaces;
        let (least, most) = ends(corners.map(|at| self.shares[at]));
        let (near, far) = ends(corners.map(|at| range.data()[at]));
        if corners.iter().all(|&at| facing[at] != AWAY) && far <= ALIKE * near && most - least > READ_UP_TO {
            return;
        }
        let unit = 1.0 / cell.step as f32;
        for (y, row) in self.rows(cell).enumerate() {
            let v = y as f32 * unit;
            for (x, at) in row.enumerate() {
                if facing[at] < LIT || self.shares[at] != UNKNOWN {
                    continue;
                }
                let u = x as f32 * unit;
                let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
                let (mut sum, mut whole) = (0.0, 0.0);
                let (mut least, mut most) = (f32::INFINITY, f32::NEG_INFINITY);
                for (corner, weight) in corners.into_iter().zip(weights) {
                    let [one, other] = [range.data()[at], range.data()[corner]];
                    let is_alike = one.max(other) <= ALIKE * one.min(other);
                    if weight > 0.0 && facing[corner] != AWAY && is_alike {
                        let share = self.shares[corner];
                        (sum, whole) = (sum + weight * share, whole + weight);
                        (least, most) = (least.min(share), most.max(share));
                    }
                }
                let is_small = facing[at] == IN_BEAM && seen[at] < 0.5 && least > OPEN;
                if whole >= 0.5 && most - least <= READ_UP_TO && !is_small {
                    self.shares[at] = sum / whole;
                }
            }
        }
    }

    /// Reads the pixels of a cell between its corners.
    fn read(&mut self, cell: Cell) {
        let corners = self.corners(cell);
        let [a, b, c, d] = corners.map(|at| self.shares[at]);
        let width = self.surfaces.range.width();
        let (columns, rows) = (corners[1] - corners[0], (corners[2] - corners[0]) / width);
        let unit = [columns, rows].map(|count| 1.0 / count.max(1) as f32);
        for (y, row) in self.rows(cell).enumerate() {
            let v = y as f32 * unit[1];
            let (left, right) = (a + v * (c - a), b + v * (d - b));
            for (x, share) in self.shares[row].iter_mut().enumerate() {
                *share = left + x as f32 * unit[0] * (right - left);
            }
        }
    }
}

impl Cell {
    fn quarters(self) -> impl Iterator<Item = Self> {
        let Self { x, y, step } = self;
        let step = step / 2;
        [(x, y), (x + step, y), (x, y + step), (x + step, y + step)]
            .into_iter()
            .map(move |(x, y)| Self { x, y, step })
    }
}

/// The least and the greatest of some values.
fn ends(values: [f32; 4]) -> (f32, f32) {
    values
        .into_iter()
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(least, most), v| {
            (least.min(v), most.max(v))
        })
}

#[cfg(test)]
mod tests;
