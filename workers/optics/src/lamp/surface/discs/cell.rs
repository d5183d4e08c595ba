//! Cells of pixels, and their interpolation between the four traced corners.

use imaging::simd::{larger, smaller};

use super::UNKNOWN;
use crate::lamp::surface::shade::{IN_BEAM, LIT};
use crate::view::lattice::{ALIKE, READ_UP_TO};

/// If corners see more of the disc, but pixels between them less than half of the lamp, a small occluder is likely.
const OPEN: f32 = 0.9;

/// Pixels with traced corners: `step` columns and rows, fewer at the end of the frame.
#[derive(Clone, Copy)]
pub(super) struct Cell {
    pub(super) x: usize,
    pub(super) y: usize,
    pub(super) step: usize,
}

/// A quantity of the pixels of a cell, row by row.
pub(super) type Lanes<const SIDE: usize> = [[f32; SIDE]; SIDE];

/// State of the pixels of a cell.
pub(super) struct Pixels<const SIDE: usize> {
    pub(super) meters: Lanes<SIDE>,
    /// Orientation to the lamp.
    pub(super) facing: Lanes<SIDE>,
    /// How much of the lamp itself is seen from them.
    pub(super) seen: Lanes<SIDE>,
}

/// State of the corners of a cell: of the pixels left and right in its first row, and in the first row below it.
pub(super) struct Corners {
    pub(super) meters: [f32; 4],
    /// How much of the disc is seen from each.
    pub(super) shares: [f32; 4],
    /// Whether each corner faces the lamp and was traced.
    pub(super) faces: [bool; 4],
}

impl<const SIDE: usize> Default for Pixels<SIDE> {
    fn default() -> Self {
        let zeros = [[0.0; SIDE]; SIDE];
        Self {
            meters: zeros,
            facing: zeros,
            seen: zeros,
        }
    }
}

impl Cell {
    pub(super) fn quarters(self) -> impl Iterator<Item = Self> {
        let Self { x, y, step } = self;
        let step = step / 2;
        [(x, y), (x + step, y), (x, y + step), (x + step, y + step)]
            .into_iter()
            .map(move |(x, y)| Self { x, y, step })
    }

    /// Writes the shares of its pixels into those of the frame.
    pub(super) fn write<const SIDE: usize>(
        self,
        frame: &mut [f32],
        (width, height): (usize, usize),
        lanes: &Lanes<SIDE>,
    ) {
        let columns = self.x.min(width)..(self.x + SIDE).min(width);
        for (lane, y) in lanes.iter().zip(self.y..height) {
            let row = &mut frame[y * width..][columns.clone()];
            row.iter_mut()
                .zip(lane)
                .for_each(|(share, found)| *share = *found);
        }
    }
}

/// Copies the pixels of a cell from a quantity of the frame, and `beyond` for those outside the frame.
#[inline(always)]
pub(super) fn take<const SIDE: usize>(
    lanes: &mut Lanes<SIDE>,
    (frame, beyond): (&[f32], f32),
    (width, height): (usize, usize),
    cell: Cell,
) {
    if cell.x + SIDE <= width && cell.y + SIDE <= height {
        for (y, lane) in lanes.iter_mut().enumerate() {
            let begin = (cell.y + y) * width + cell.x;
            let (row, _) = frame[begin..]
                .split_first_chunk()
                .expect("the cell is in the frame");
            *lane = *row;
        }
        return;
    }
    lanes.as_flattened_mut().fill(beyond);
    let columns = cell.x.min(width)..(cell.x + SIDE).min(width);
    for (lane, y) in lanes.iter_mut().zip(cell.y..height) {
        let row = &frame[y * width..][columns.clone()];
        lane[..row.len()].copy_from_slice(row);
    }
}

/// Whether a lit pixel has an unknown share.
#[inline(always)]
pub(super) fn is_open<const SIDE: usize>(facing: &Lanes<SIDE>, shares: &Lanes<SIDE>) -> bool {
    let mut is_open = false;
    for y in 0..SIDE {
        for x in 0..SIDE {
            is_open |= (facing[y][x] >= LIT) & (shares[y][x] == UNKNOWN);
        }
    }
    is_open
}

impl Corners {
    /// Whether a cell shows one surface whose corners have similar visible shares of the disc, and of the lamp in the beam.
    #[inline(always)]
    pub(super) fn show<const SIDE: usize>(&self, pixels: &Pixels<SIDE>) -> bool {
        let (least, most) = ends(self.shares);
        if !self.faces.into_iter().all(|faces| faces) || most - least > READ_UP_TO {
            return false;
        }
        let (near, far) = ends(self.meters);
        let (mut nearest, mut farthest, mut hidden) = ([near; SIDE], [far; SIDE], [false; SIDE]);
        for y in 0..SIDE {
            for x in 0..SIDE {
                let (meters, facing) = (pixels.meters[y][x], pixels.facing[y][x]);
                let is_lit = facing >= LIT;
                nearest[x] = smaller(if is_lit { meters } else { nearest[x] }, nearest[x]);
                farthest[x] = larger(if is_lit { meters } else { farthest[x] }, farthest[x]);
                hidden[x] |= (facing == IN_BEAM) & (pixels.seen[y][x] < 0.5);
            }
        }
        let nearest = nearest.into_iter().fold(f32::INFINITY, smaller);
        let farthest = farthest.into_iter().fold(f32::NEG_INFINITY, larger);
        let is_hidden = hidden.into_iter().any(|hidden| hidden);
        farthest <= ALIKE * nearest && !(is_hidden && least > OPEN)
    }

    /// Sets the shares of the pixels of a cell between corners that are `apart` columns and rows from each other.
    #[inline(always)]
    pub(super) fn read_between<const SIDE: usize>(&self, apart: [usize; 2], shares: &mut Lanes<SIDE>) {
        let [a, b, c, d] = self.shares;
        let unit = apart.map(|count| 1.0 / count.max(1) as f32);
        for (y, row) in shares.iter_mut().enumerate() {
            let v = y as f32 * unit[1];
            let (left, right) = (a + v * (c - a), b + v * (d - b));
            for (x, share) in row.iter_mut().enumerate() {
                *share = left + x as f32 * unit[0] * (right - left);
            }
        }
    }

    /// Whether different shares of the disc are seen from the corners of one surface.
    pub(super) fn differ(&self) -> bool {
        let ((least, most), (near, far)) = (ends(self.shares), ends(self.meters));
        self.faces.into_iter().all(|faces| faces) && far <= ALIKE * near && most - least > READ_UP_TO
    }

    /// Sets the shares of those pixels whose surface the corners show for the most part.
    #[inline(always)]
    pub(super) fn read_alike<const SIDE: usize>(&self, pixels: &Pixels<SIDE>, shares: &mut Lanes<SIDE>) {
        let unit = 1.0 / SIDE as f32;
        for y in 0..SIDE {
            let v = y as f32 * unit;
            for x in 0..SIDE {
                let u = x as f32 * unit;
                let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
                let (meters, facing, known) = (pixels.meters[y][x], pixels.facing[y][x], shares[y][x]);
                let (mut sum, mut whole) = (0.0, 0.0);
                let (mut least, mut most) = (f32::INFINITY, f32::NEG_INFINITY);
                for corner in 0..4 {
                    let (other, share) = (self.meters[corner], self.shares[corner]);
                    let is_alike = larger(meters, other) <= ALIKE * smaller(meters, other);
                    let counts = is_alike & self.faces[corner] & (weights[corner] > 0.0);
                    let weight = if counts { weights[corner] } else { 0.0 };
                    (sum, whole) = (sum + weight * share, whole + weight);
                    least = smaller(if counts { share } else { least }, least);
                    most = larger(if counts { share } else { most }, most);
                }
                let is_small = (facing == IN_BEAM) & (pixels.seen[y][x] < 0.5) & (least > OPEN);
                let is_read = (facing >= LIT)
                    & (known == UNKNOWN)
                    & (whole >= 0.5)
                    & (most - least <= READ_UP_TO)
                    & !is_small;
                shares[y][x] = if is_read { sum / whole } else { known };
            }
        }
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
