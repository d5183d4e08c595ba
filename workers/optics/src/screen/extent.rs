//! Depth bounds of the surfaces in parts of a picture: of each cell of four samples, and of squares of two by two, four by four and
//! so on of them.
//!
//! A ray in front of all surfaces of a square, or behind all by more than their thickness, does not intersect any over it.

use imaging::Plane;

/// Beyond the outermost samples a cell is continued by half of it to each side: to no more than this many times the difference of its
/// samples beyond them, as the weights of the four then add up to 4 at most without their signs.
const CONTINUED: f64 = 1.5;

/// The least and the greatest 1/z of squares of cells, level by level; those of holes alone are infinite and minus infinite.
pub(super) struct Extent {
    levels: Vec<Plane<[f64; 2]>>,
}

/// A square of cells.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Square {
    pub(super) level: usize,
    column: usize,
    row: usize,
}

impl Square {
    /// The square of a level that contains a cell.
    pub(super) fn around((column, row): (usize, usize), level: usize) -> Self {
        Self {
            level,
            column: column >> level,
            row: row >> level,
        }
    }

    /// The samples at the corners of a cell, in a picture of this size.
    pub(super) fn samples(self, (width, height): (usize, usize)) -> impl Iterator<Item = (usize, usize)> {
        let corners = [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter();
        let samples = corners.map(move |(dx, dy)| (self.column + dx, self.row + dy));
        samples.filter(move |(x, y)| *x < width && *y < height)
    }

    /// Bounds of the columns, or rows, of its cells.
    pub(super) fn edges(self, axis: usize) -> [f64; 2] {
        let at = [self.column, self.row][axis];
        [at << self.level, (at + 1) << self.level].map(|v| v as f64)
    }
}

impl Extent {
    /// Bounds of the samples of a picture of 1/z, NaN at holes.
    pub(super) fn new(inverse: &Plane<f64>) -> Self {
        let (width, height) = inverse.size();
        let (columns, rows) = ((width - 1).max(1), (height - 1).max(1));
        let mut levels = vec![Plane::from_fn(columns, rows, |x, y| {
            let is_outer = x == 0 || y == 0 || x + 1 == columns || y + 1 == rows;
            of_cell(inverse, (x, y), is_outer)
        })];
        while let Some(last) = levels.last().filter(|last| last.size() != (1, 1)) {
            let (columns, rows) = last.size();
            let next = Plane::from_fn(columns.div_ceil(2), rows.div_ceil(2), |x, y| {
                let part = |dx: usize, dy: usize| {
                    last.pixel((2 * x + dx).min(columns - 1), (2 * y + dy).min(rows - 1))
                };
                joined([part(0, 0), part(1, 0), part(0, 1), part(1, 1)])
            });
            levels.push(next);
        }
        Self { levels }
    }

    /// The coarsest level there is.
    pub(super) fn top(&self) -> usize {
        self.levels.len() - 1
    }

    /// The square that contains all others.
    pub(super) fn whole(&self) -> Square {
        Square::around((0, 0), self.top())
    }

    /// The squares of the next finer level in a square; `None` for a cell.
    pub(super) fn parts(&self, square: Square) -> Option<impl Iterator<Item = Square> + use<>> {
        let level = square.level.checked_sub(1)?;
        let (columns, rows) = self.levels[level].size();
        let parts = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| Square {
            level,
            column: 2 * square.column + dx,
            row: 2 * square.row + dy,
        });
        Some(
            parts
                .into_iter()
                .filter(move |part| part.column < columns && part.row < rows),
        )
    }

    /// The least and the greatest 1/z in a square.
    pub(super) fn of(&self, square: Square) -> [f64; 2] {
        self.levels[square.level].pixel(square.column, square.row)
    }
}

fn of_cell(inverse: &Plane<f64>, (x, y): (usize, usize), is_outer: bool) -> [f64; 2] {
    let (width, height) = inverse.size();
    let (right, bottom) = ((x + 1).min(width - 1), (y + 1).min(height - 1));
    let corners = [(x, y), (right, y), (x, bottom), (right, bottom)];
    let corners = corners.map(|(x, y)| inverse.pixel(x, y)).map(|v| {
        if v.is_nan() {
            [f64::INFINITY, f64::NEG_INFINITY]
        } else {
            [v, v]
        }
    });
    let [least, most] = joined(corners);
    if is_outer && least < most {
        let beyond = CONTINUED * (most - least);
        return [least - beyond, most + beyond];
    }
    [least, most]
}

fn joined(parts: [[f64; 2]; 4]) -> [f64; 2] {
    let empty = [f64::INFINITY, f64::NEG_INFINITY];
    parts
        .into_iter()
        .fold(empty, |[a, b], [least, most]| [a.min(least), b.max(most)])
}
