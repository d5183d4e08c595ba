//! Quantities that change at few pixels, such as the visible share of a lamp: rays start at the nodes of a lattice, and at every
//! pixel near a change.
//!
//! A pixel is interpolated between those corners of its cell that show the same surface, if they have similar values and more than
//! half of the weight. All others are traced, and one more pixel of each cell, at places that change from cell to cell, so that no
//! narrow line passes between all of them. If a traced pixel differs from an interpolated one next to it, the cell of that one is
//! traced too: an edge is followed wherever it leads. Missed features are smaller than a cell, or narrower than three pixels and
//! shorter than a few cells.

use imaging::Plane;

use super::tiles::in_tiles;

/// The most columns and rows of a cell, and its largest angle, rad.
const STEP: usize = 4;
const ANGLE: f64 = 1.0 / 100.0;
/// Surfaces whose ranges differ by less than this factor are treated as one.
pub(crate) const ALIKE: f32 = 1.05;
/// Values that differ by no more than this are interpolated.
pub(crate) const READ_UP_TO: f32 = 0.25;
/// Marks pixels without a value.
const UNKNOWN: f32 = -1.0;
/// Least weight of the corners that show the surface of a pixel.
const LEAST_WEIGHT: f32 = 0.5;

struct Lattice<'a, W> {
    range: &'a [f32],
    is_wanted: W,
    size: (usize, usize),
    /// Columns and rows of a cell.
    step: usize,
    values: Vec<f32>,
    /// Which of them are interpolated.
    is_read: Vec<bool>,
}

/// Four pixels: the first ones of a cell and of its neighbors right and below, or the last ones of the picture.
struct Corners {
    pixels: [usize; 4],
    /// Columns and rows between them.
    apart: [usize; 2],
}

/// The values of wanted pixels, 0..=1, and `other` for the rest. `trace` computes those of a list of pixels, in its
/// order; neighbors in the list are neighbors in the picture. Every wanted pixel of a picture with a short focal length is traced.
pub(crate) fn trace_changes(
    (range, focal_px): (&Plane<f32>, f64),
    is_wanted: impl Fn(usize) -> bool,
    other: f32,
    mut trace: impl FnMut(&[usize], &mut Vec<f32>),
) -> Vec<f32> {
    let mut lattice = Lattice::new((range, focal_px), is_wanted, other);
    let mut found = Vec::new();
    let nodes = lattice.nodes();
    trace(&nodes, &mut found);
    lattice.store(&nodes, &found);
    let mut pixels = lattice.read_cells();
    while !pixels.is_empty() {
        trace(&pixels, &mut found);
        lattice.store(&pixels, &found);
        pixels = lattice.forget_neighbors(&pixels);
    }
    lattice.values
}

impl<'a, W: Fn(usize) -> bool> Lattice<'a, W> {
    fn new((range, focal_px): (&'a Plane<f32>, f64), is_wanted: W, other: f32) -> Self {
        let count = range.data().len();
        let blank = |at| if is_wanted(at) { UNKNOWN } else { other };
        Self {
            range: range.data(),
            size: range.size(),
            step: ((ANGLE * focal_px) as usize).clamp(1, STEP),
            values: (0..count).map(blank).collect(),
            is_read: vec![false; count],
            is_wanted,
        }
    }

    /// The wanted nodes: the first pixel of each cell, and those in the last column and row of the picture.
    fn nodes(&self) -> Vec<usize> {
        let (width, height) = self.size;
        let count = |side: usize| (side - 1).div_ceil(self.step) + 1;
        in_tiles(count(width), count(height))
            .map(|(column, row)| {
                (row * self.step).min(height - 1) * width + (column * self.step).min(width - 1)
            })
            .filter(|at| (self.is_wanted)(*at))
            .collect()
    }

    fn store(&mut self, pixels: &[usize], found: &[f32]) {
        for (&at, &value) in pixels.iter().zip(found) {
            self.values[at] = value;
        }
    }

    /// Interpolates the pixels whose corners allow it, and lists the others and one of each cell.
    fn read_cells(&mut self) -> Vec<usize> {
        let (width, height) = self.size;
        let mut open = Vec::new();
        for (column, row) in in_tiles(width.div_ceil(self.step), height.div_ceil(self.step)) {
            let place = (column * self.step, row * self.step);
            let corners = self.corners(place);
            let (right, below) = probe(column, row, self.step);
            let probe = (place.1 + below) * width + place.0 + right;
            for at in self.pixels(place) {
                if self.values[at] != UNKNOWN {
                    continue;
                }
                match self.read(&corners, at).filter(|_| at != probe) {
                    Some(value) => (self.values[at], self.is_read[at]) = (value, true),
                    None => open.push(at),
                }
            }
        }
        open
    }

    /// The pixels of the cell that begins at this one.
    fn pixels(&self, (left, top): (usize, usize)) -> impl Iterator<Item = usize> + use<W> {
        let (width, height) = self.size;
        let (right, bottom) = ((left + self.step).min(width), (top + self.step).min(height));
        (top..bottom).flat_map(move |y| (left..right).map(move |x| y * width + x))
    }

    fn corners(&self, (left, top): (usize, usize)) -> Corners {
        let (width, height) = self.size;
        let (right, below) = (
            (left + self.step).min(width - 1),
            (top + self.step).min(height - 1),
        );
        Corners {
            pixels: [(left, top), (right, top), (left, below), (right, below)].map(|(x, y)| y * width + x),
            apart: [right - left, below - top],
        }
    }

    /// The value of a pixel by those corners that show its surface.
    fn read(&self, corners: &Corners, at: usize) -> Option<f32> {
        let (width, first) = (self.size.0, corners.pixels[0]);
        let [u, v] = [at % width - first % width, at / width - first / width];
        let [u, v] =
            [(u, corners.apart[0]), (v, corners.apart[1])].map(|(v, all)| v as f32 / all.max(1) as f32);
        let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
        let (mut sum, mut whole) = (0.0, 0.0);
        let (mut least, mut most) = (f32::INFINITY, f32::NEG_INFINITY);
        for (corner, weight) in corners.pixels.into_iter().zip(weights) {
            if weight > 0.0 && (self.is_wanted)(corner) && self.is_one(at, corner) {
                let value = self.values[corner];
                (sum, whole) = (sum + weight * value, whole + weight);
                (least, most) = (least.min(value), most.max(value));
            }
        }
        (whole > LEAST_WEIGHT && most - least <= READ_UP_TO).then(|| sum / whole)
    }

    /// Whether two pixels show one surface.
    fn is_one(&self, one: usize, other: usize) -> bool {
        let [one, other] = [one, other].map(|at| self.range[at]);
        one.max(other) <= ALIKE * one.min(other)
    }

    /// Forgets the interpolated values in the cells next to traced pixels that differ from them, and lists their pixels.
    fn forget_neighbors(&mut self, traced: &[usize]) -> Vec<usize> {
        let mut forgotten = Vec::new();
        for &at in traced {
            for neighbor in self.neighbors(at) {
                let is_other = (self.values[at] - self.values[neighbor]).abs() > READ_UP_TO;
                if self.is_read[neighbor] && is_other && self.is_one(at, neighbor) {
                    let (x, y) = (neighbor % self.size.0, neighbor / self.size.0);
                    for pixel in self.pixels((x - x % self.step, y - y % self.step)) {
                        if std::mem::take(&mut self.is_read[pixel]) {
                            forgotten.push(pixel);
                        }
                    }
                }
            }
        }
        forgotten
    }

    /// The pixels around a pixel.
    fn neighbors(&self, at: usize) -> impl Iterator<Item = usize> + use<W> {
        let (width, height) = self.size;
        let (x, y) = (at % width, at / width);
        let rows = y.saturating_sub(1)..(y + 2).min(height);
        let all =
            rows.flat_map(move |y| (x.saturating_sub(1)..(x + 2).min(width)).map(move |x| y * width + x));
        all.filter(move |neighbor| *neighbor != at)
    }
}

/// Column and row, in a cell, of its second traced pixel. The positions have no pattern, so that along any line of cells one is soon on each
/// line of pixels.
fn probe(column: usize, row: usize, step: usize) -> (usize, usize) {
    let mixed = (column as u32).wrapping_mul(0x9e37_79b1) ^ (row as u32).wrapping_mul(0x85eb_ca77);
    let number = ((mixed ^ (mixed >> 15)).wrapping_mul(0x2c1b_3c6d) >> 16) as usize;
    (number % step, number / step % step)
}

#[cfg(test)]
mod tests;
