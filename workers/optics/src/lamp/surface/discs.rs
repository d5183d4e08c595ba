//! Visible share, from surfaces, of the disc of a lamp's scattered light. Such shadows are wide: the disc is sampled from points a
//! degree or two apart first, from more of them if its visible share changes, and from each at edges.

mod cell;

use imaging::rays::Rays;
use imaging::vectorized;

use self::cell::{Cell, Corners, Lanes, Pixels, take};
use super::shade::{AWAY, Surfaces};
use crate::lamp::Lighting;
use crate::lamp::multiple::surface_scale;
use crate::lamp::shadow::SPREAD_PLACES;
use crate::lamp::sight::{Disc, Radius, Sight, Starts};
use crate::view::tiles::in_tiles;

/// The most columns and rows of the cells whose corners are traced first, and the largest angle of a cell, rad.
const STEP: usize = 8;
/// `settle` and `is_open` know cells of this side and its halves.
const _: () = assert!(STEP == 8);
const ANGLE: f64 = 1.0 / 48.0;
/// Channels whose scattering differs by no more than this factor share a disc. The radii differ by 12 % at most then, and the
/// visible share past a straight edge by 0.04: it changes by dR/(π R) at most.
const SHARED_UP_TO: f64 = 1.2;
/// Marks shares that are not traced yet.
const UNKNOWN: f32 = -1.0;

/// Visible shares of the discs of a lamp.
pub(super) struct Discs {
    /// Of the pixels of the frame: a share of all channels, or one of each.
    shares: Vec<Vec<f32>>,
    width: usize,
}

/// The surfaces that the discs are traced from.
#[derive(Clone, Copy)]
pub(super) struct LitSurfaces<'a> {
    pub(super) surfaces: Surfaces<'a>,
    /// For each pixel of the frame: orientation to the lamp, and visible share of the lamp.
    pub(super) facing: &'a [f32],
    pub(super) seen: &'a [f32],
}

impl Discs {
    pub(super) fn new(lighting: &Lighting, lamp: [f32; 3], rays: &dyn Rays, of: LitSurfaces<'_>) -> Self {
        let b = lighting.scattering;
        let (least, most) = b.into_iter().fold((f64::INFINITY, 0.0f64), |(least, most), b| {
            (least.min(b), most.max(b))
        });
        let search = |b: f64| Search::new(lighting, (lamp, b), rays, of).shares();
        let shares = if most <= SHARED_UP_TO * least {
            vec![search((least * most).sqrt())]
        } else {
            let [small, large] = [search(least), search(most)];
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
            width: of.surfaces.range.width(),
        }
    }

    /// Visible share of the disc of each channel from row `y`.
    pub(super) fn of_row(&self, y: usize) -> [&[f32]; 3] {
        [0, 1, 2].map(|channel| {
            let of_frame = &self.shares[channel.min(self.shares.len() - 1)];
            &of_frame[y * self.width..(y + 1) * self.width]
        })
    }
}

/// Looks for one disc.
struct Search<'a> {
    lighting: &'a Lighting,
    of: LitSurfaces<'a>,
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
        of: LitSurfaces<'a>,
    ) -> Self {
        Self {
            lighting,
            of,
            lamp,
            scattering,
            disc: Disc::new(SPREAD_PLACES),
            sight: Sight::new(rays),
            shares: vec![UNKNOWN; of.facing.len()],
        }
    }

    fn shares(mut self) -> Vec<f32> {
        let (width, height) = self.of.surfaces.range.size();
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
            for cell in cells {
                let is_divided = match cell.step {
                    8 => self.settle::<8>(cell),
                    4 => self.settle::<4>(cell),
                    2 => self.settle::<2>(cell),
                    _ => false,
                };
                if is_divided {
                    parts.extend(cell.quarters().filter(|part| self.is_open(*part)));
                }
            }
            cells = parts;
        }
        self.shares
    }

    /// Whether a cell has a lit surface without a known share.
    fn is_open(&self, cell: Cell) -> bool {
        match cell.step {
            8 => self.is_open_of::<8>(cell),
            4 => self.is_open_of::<4>(cell),
            2 => self.is_open_of::<2>(cell),
            _ => self.is_open_of::<1>(cell),
        }
    }

    fn is_open_of<const SIDE: usize>(&self, cell: Cell) -> bool {
        let size = self.of.surfaces.range.size();
        let (mut facing, mut shares): (Lanes<SIDE>, Lanes<SIDE>) =
            ([[AWAY; SIDE]; SIDE], [[0.0; SIDE]; SIDE]);
        take(&mut facing, (self.of.facing, AWAY), size, cell);
        take(&mut shares, (&self.shares, 0.0), size, cell);
        vectorized!(cell::is_open(&facing, &shares))
    }

    /// Interpolates the pixels of a cell whose corners allow it. Returns whether the cell must be divided for the others.
    fn settle<const SIDE: usize>(&mut self, cell: Cell) -> bool {
        let LitSurfaces {
            surfaces: Surfaces { range, .. },
            facing,
            seen,
        } = self.of;
        let size = range.size();
        let at = self.corners(cell);
        let corners = Corners {
            meters: at.map(|at| range.data()[at]),
            shares: at.map(|at| self.shares[at]),
            faces: at.map(|at| facing[at] != AWAY),
        };
        let mut pixels = Pixels::<SIDE>::default();
        take(&mut pixels.meters, (range.data(), 0.0), size, cell);
        take(&mut pixels.facing, (facing, AWAY), size, cell);
        take(&mut pixels.seen, (seen, 1.0), size, cell);
        let mut shares: Lanes<SIDE> = [[0.0; SIDE]; SIDE];
        let is_divided = !vectorized!(corners.show(&pixels));
        if !is_divided {
            let apart = [at[1] - at[0], (at[2] - at[0]) / size.0];
            vectorized!(corners.read_between(apart, &mut shares));
        } else if !corners.differ() {
            take(&mut shares, (&self.shares, 0.0), size, cell);
            vectorized!(corners.read_alike(&pixels, &mut shares));
        } else {
            return true;
        }
        cell.write(&mut self.shares, size, &shares);
        is_divided
    }

    /// The pixels at the corners of a cell; a single pixel has but one.
    fn corners(&self, Cell { x, y, step }: Cell) -> [usize; 4] {
        let (width, height) = self.of.surfaces.range.size();
        let step = if step == 1 { 0 } else { step };
        let (right, below) = ((x + step).min(width - 1), (y + step).min(height - 1));
        [(x, y), (right, y), (x, below), (right, below)].map(|(x, y)| y * width + x)
    }

    fn look_from_corners(&mut self, cells: &[Cell]) {
        let (mut pixels, mut starts, mut radii) = (Vec::new(), Starts::default(), Vec::new());
        for cell in cells {
            for at in self.corners(*cell) {
                if self.shares[at] == UNKNOWN && self.of.facing[at] != AWAY {
                    // Prevents another trace for the next cell.
                    self.shares[at] = 0.0;
                    let start = self.of.surfaces.start(at);
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
}

#[cfg(test)]
mod tests;
