//! Exact values of every few pixels, with interpolation between them if the picture allows it.

use imaging::Plane;

use crate::range::is_hole;
use crate::view::lattice::ALIKE;
use crate::view::tiles::{TILE, in_tiles};

/// The nodes of a grid over a picture: every `step`-th column and row, and the last ones.
struct Grid {
    step: usize,
    size: (usize, usize),
    columns: usize,
    rows: usize,
}

/// The nodes around a pixel, and its position between them.
struct Cell {
    nodes: [usize; 4],
    pixels: [usize; 4],
    share: [f32; 2],
}

impl Grid {
    fn new((width, height): (usize, usize), step: usize) -> Self {
        let count = |side: usize| (side - 1).div_ceil(step) + 1;
        Self {
            step,
            size: (width, height),
            columns: count(width),
            rows: count(height),
        }
    }

    /// The pixel of a node.
    fn pixel(&self, column: usize, row: usize) -> usize {
        let x = (column * self.step).min(self.size.0 - 1);
        (row * self.step).min(self.size.1 - 1) * self.size.0 + x
    }

    /// The nodes tile by tile, each with its pixel.
    fn nodes(&self) -> (Vec<usize>, Vec<usize>) {
        let places = in_tiles(self.columns, self.rows);
        places
            .map(|(column, row)| (row * self.columns + column, self.pixel(column, row)))
            .unzip()
    }

    fn cell(&self, x: usize, y: usize) -> Cell {
        let between = |v: usize, side: usize, count: usize| {
            let first = (v / self.step).min(count.saturating_sub(2));
            let second = (first + 1).min(count - 1);
            let ends = [first, second].map(|at| (at * self.step).min(side - 1));
            let length = (ends[1] - ends[0]).max(1) as f32;
            (first, second, (v - ends[0]) as f32 / length)
        };
        let (left, right, u) = between(x, self.size.0, self.columns);
        let (top, bottom, v) = between(y, self.size.1, self.rows);
        let corners = [(left, top), (right, top), (left, bottom), (right, bottom)];
        Cell {
            nodes: corners.map(|(column, row)| row * self.columns + column),
            pixels: corners.map(|(column, row)| self.pixel(column, row)),
            share: [u, v],
        }
    }
}

/// The values of all pixels. `exact` computes those of a list of pixels, in its order; the lists are ordered tile by tile. Pixels
/// between the nodes are interpolated linearly on one surface if `may_read` agrees, given a pixel and the values around it. Pixels
/// that are not `wanted` are 1.
pub(super) fn fill<const N: usize>(
    range: &Plane<f32>,
    step: usize,
    wanted: impl Fn(usize) -> bool,
    may_read: impl Fn(usize, &[[f32; N]; 4]) -> bool,
    mut exact: impl FnMut(&[usize], &mut Vec<[f32; N]>),
) -> Vec<[f32; N]> {
    let (width, height) = range.size();
    let grid = Grid::new((width, height), step);
    let mut all = vec![[1.0f32; N]; width * height];
    let (numbers, pixels) = grid.nodes();
    let (mut own, mut values) = (Vec::new(), Vec::new());
    exact(&pixels, &mut values);
    let mut nodes = vec![[1.0f32; N]; numbers.len()];
    for (&node, value) in numbers.iter().zip(&values) {
        nodes[node] = *value;
    }
    for top in (0..height).step_by(TILE) {
        own.clear();
        in_tiles(width, TILE.min(height - top)).for_each(|(x, y)| {
            let (y, at) = (top + y, (top + y) * width + x);
            if !wanted(at) {
                return;
            }
            let cell = grid.cell(x, y);
            let around = cell.nodes.map(|node| nodes[node]);
            if is_one(range.data(), at, cell.pixels) && may_read(at, &around) {
                let [u, v] = cell.share;
                let [a, b, c, d] = around;
                all[at] = std::array::from_fn(|i| {
                    let (top, bottom) = (a[i] + u * (b[i] - a[i]), c[i] + u * (d[i] - c[i]));
                    top + v * (bottom - top)
                });
            } else {
                own.push(at);
            }
        });
        exact(&own, &mut values);
        for (&at, value) in own.iter().zip(&values) {
            all[at] = *value;
        }
    }
    all
}

/// Whether a pixel and those around it show one surface, or open water all of them.
fn is_one(range: &[f32], at: usize, around: [usize; 4]) -> bool {
    let hole = |at: usize| is_hole(range[at]);
    if hole(at) {
        return around.into_iter().all(hole);
    }
    if around.into_iter().any(hole) {
        return false;
    }
    let ranges = around.map(|at| range[at]);
    let (least, most) = ranges
        .into_iter()
        .fold((range[at], range[at]), |(least, most), z| {
            (least.min(z), most.max(z))
        });
    most <= ALIKE * least
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_is_read_as_it_is_and_an_edge_is_looked_at() {
        for (width, height) in [(1, 1), (2, 5), (9, 7), (17, 13)] {
            for step in [2, 4] {
                let range = Plane::from_fn(width, height, |x, _| if x > width / 2 { 4.0 } else { 2.0 });
                let ramp = |at: usize| [(at % width) as f32, (at / width) as f32 * 0.5];
                let mut asked = 0;
                let values = fill(
                    &range,
                    step,
                    |at| at % 5 != 3,
                    |_, _| true,
                    |pixels, values| {
                        asked += pixels.len();
                        values.clear();
                        values.extend(pixels.iter().map(|&at| ramp(at)));
                    },
                );
                for (at, value) in values.iter().enumerate() {
                    let expected = if at % 5 == 3 { [1.0; 2] } else { ramp(at) };
                    assert!((0..2).all(|i| (value[i] - expected[i]).abs() < 1e-5), "{at}");
                }
                assert!(asked <= 2 * width * height + 4);
            }
        }
    }
}
