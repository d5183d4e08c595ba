//! Second and third differences of light between rays, and the interpolation error.
//!
//! Between two rays light is interpolated by a parabola: a line, less x (1 − x)/2 times the mean of the second differences at both
//! rays. The third differences show its error. Those at the two rays alone would miss a kink halfway between them, at which second
//! differences are equal, so a pair of blocks is checked together, each with its possible kink.

use imaging::simd::{larger, smaller};

use super::line::{Line, Ray, between_degrees, turns};
use super::{BETWEEN_CELLS, BETWEEN_DEGREES, BETWEEN_RAYS, BETWEEN_RAYS_BENT, WITHIN_CELL};

/// Rays across a pair of blocks: one before, three of their corners, one behind.
pub(super) const ACROSS: usize = 5;

/// A block of pixels among the lines of rays of a pair of rows.
#[derive(Clone, Copy)]
pub(super) struct Place<'a> {
    lines: &'a [Line],
    /// Column and row within its pairs, 0 or 1, and the first ray of those across its pair of columns.
    at: [usize; 2],
    first: usize,
}

/// Second differences of a cell between four rays: across on those above and below, down on those to the left and to the right.
#[derive(Clone, Copy)]
pub(super) struct Bend {
    pub(super) across: [[f32; 16]; 2],
    pub(super) down: [[f32; 16]; 2],
}

/// Of the sums up to the ends of cells.
type Ends = [f32; 4];

impl<'a> Place<'a> {
    pub(super) fn new(lines: &'a [Line], (column, row): (usize, usize)) -> Self {
        assert_eq!(lines.len(), ACROSS, "of a pair of rows");
        Self {
            lines,
            at: [column % 2, row % 2],
            first: column - column % 2,
        }
    }

    /// The lines above and below.
    pub(super) fn beside(&self) -> [&'a Line; 2] {
        [1, 2].map(|line| &self.lines[line + self.at[1]])
    }

    /// The rays to the left and to the right.
    pub(super) fn rays(&self) -> [usize; 2] {
        [1, 2].map(|ray| self.first + ray + self.at[0])
    }

    fn ray(&self, line: usize, ray: usize, degree: usize) -> Ray<'a> {
        self.lines[line].in_degree(self.first + ray, degree)
    }

    /// Error estimate in some cells beyond a share of the light that ends there; of linear interpolation if these are not `bent`.
    pub(super) fn left(&self, cells: (usize, usize), is_bent: bool, share: f32) -> f64 {
        let degrees = self.lines[0].count();
        let mut between = [0.0f32; 3];
        for degree in 0..degrees {
            let worst = self.between_rays(cells, degree, is_bent);
            between = [0, 1, 2].map(|i| larger(worst[i], between[i]));
        }
        let next = (cells.0, self.lines[0].next(cells.1));
        let mut own = 0.0f32;
        for line in self.beside() {
            for ray in self.rays() {
                let degrees: Vec<Ray<'_>> = line.ray(ray).collect();
                let most = |of: &dyn Fn(Ray<'_>) -> f32| degrees.iter().map(|&ray| of(ray)).fold(0.0, larger);
                let along = BETWEEN_CELLS * most(&|ray| ray.bumps(next.1))
                    + WITHIN_CELL * most(&|ray| turns(ray, next));
                let degrees = (degrees.windows(4))
                    .map(|four| between_degrees(four, cells))
                    .fold(0.0, larger);
                own = larger(along + BETWEEN_DEGREES * degrees, own);
            }
        }
        let least = self.least_light(cells.0);
        let left = [0, 1, 2].map(|i| between[i] + own - share * least[i]);
        f64::from(left.into_iter().fold(0.0, larger))
    }

    /// The least light of the four rays up to a cell, in each channel.
    fn least_light(&self, cell: usize) -> [f32; 3] {
        let mut least = [f32::INFINITY; 3];
        for line in self.beside() {
            for ray in self.rays() {
                for degree in line.ray(ray) {
                    let light = degree.start(cell);
                    least = [0, 1, 2].map(|i| smaller(light[i], least[i]));
                }
            }
        }
        least
    }

    /// Largest error estimate of each channel at the ends of some cells.
    fn between_rays(&self, (first, last): (usize, usize), degree: usize, is_bent: bool) -> [f32; 4] {
        let [column, row] = self.at;
        let lines =
            [1, 2].map(|line| std::array::from_fn::<_, ACROSS, _>(|ray| self.ray(line + row, ray, degree)));
        let columns = [1, 2]
            .map(|ray| std::array::from_fn::<_, ACROSS, _>(|line| self.ray(line, ray + column, degree)));
        let mut worst = [0.0f32; 4];
        for cell in first.saturating_sub(1)..=last {
            let (mut bends, mut changes) = ([0.0f32; 4], [0.0f32; 4]);
            for (stencils, half) in [(&lines, column), (&columns, row)] {
                let (mut bend, mut change) = ([0.0f32; 4], [0.0f32; 4]);
                for rays in stencils {
                    look_across(&rays.map(|ray| ray.end(cell)), half, &mut bend, &mut change);
                }
                for i in 0..4 {
                    bends[i] += bend[i];
                    changes[i] += change[i];
                }
            }
            for i in 0..4 {
                let (line, parabola) = (BETWEEN_RAYS * bends[i], BETWEEN_RAYS_BENT * changes[i]);
                let left = if is_bent && parabola < line {
                    parabola
                } else {
                    line
                };
                worst[i] = larger(left, worst[i]);
            }
        }
        worst
    }

    /// The second differences for interpolating the light of some cells.
    pub(super) fn bends(&self, (first, last): (usize, usize)) -> Vec<Bend> {
        let [column, row] = self.at;
        (first..=last)
            .map(|cell| {
                let at = |line: usize, ray: usize| self.ray(line, ray, 0).at(cell);
                let mean = |four: [&[f32; 16]; 4]| {
                    let [a, b, c, d] = four;
                    std::array::from_fn(|i| 0.5 * ((a[i] - b[i]) - (c[i] - d[i])))
                };
                Bend {
                    across: [1, 2].map(|line| mean([0, 1, 2, 3].map(|ray| at(line + row, ray + column)))),
                    down: [1, 2].map(|ray| mean([0, 1, 2, 3].map(|line| at(line + row, ray + column)))),
                }
            })
            .collect()
    }
}

/// Largest second differences of five rays at the two next to a block, and largest changes from each to the next.
#[inline(always)]
fn look_across(rays: &[Ends; ACROSS], half: usize, bend: &mut Ends, change: &mut Ends) {
    for i in 0..4 {
        let second = [0, 1, 2].map(|ray| rays[ray][i] - 2.0 * rays[ray + 1][i] + rays[ray + 2][i]);
        bend[i] = larger(larger(second[half].abs(), second[half + 1].abs()), bend[i]);
        let third = [second[1] - second[0], second[2] - second[1]].map(f32::abs);
        change[i] = larger(larger(third[0], third[1]), change[i]);
    }
}
