//! Sums of spread light along the rays of every eighth pixel.

use imaging::vectorized;

use super::super::RUN;
use super::super::integrand::SpreadNode;
use super::super::intervals::{Murk, Rays, rays_of};
use super::{BETWEEN_CELLS, BETWEEN_DEGREES, BETWEEN_RAYS, CELLS, Frame, STEP, VALUES, angles_of, whole};

/// Half the distance of the two Gauss–Legendre nodes in a cell, in cells.
const NODE: f32 = 0.288_675_13;
/// The slope of a line by what it rises between them.
const SLOPE: f32 = 1.732_050_8;

/// The rays of every eighth pixel of a row, from one before the frame to one behind it, in water of one degree of murkiness:
/// [`VALUES`] for each cell, and how far the lamp is from the ray, m.
pub(super) struct Strip {
    pub(super) rays: Vec<[[f32; VALUES]; CELLS]>,
    pub(super) distance: Vec<f32>,
}

/// The sum up to the end of a cell.
fn at_end(values: &[f32; VALUES], channel: usize) -> f32 {
    values[channel] + values[channel + 3]
}

impl Strip {
    /// What may be left between each of its rays within the frame and its neighbors.
    fn left(&self, above: &Self, below: &Self) -> Vec<f64> {
        let bend = |a: &[f32; VALUES], b: &[f32; VALUES], c: &[f32; VALUES], i: usize| {
            (at_end(a, i) - 2.0 * at_end(b, i) + at_end(c, i)).abs()
        };
        let own = |at: usize| {
            let mut worst = 0.0f32;
            let ray = &self.rays[at];
            for cell in 0..CELLS {
                let [left, right] = [&self.rays[at - 1][cell], &self.rays[at + 1][cell]];
                let [up, down] = [&above.rays[at][cell], &below.rays[at][cell]];
                for i in 0..3 {
                    let turn = if cell == 0 {
                        0.0
                    } else {
                        (ray[cell][i + 6] - ray[cell - 1][i + 6]).abs()
                    };
                    let rays = bend(left, &ray[cell], right, i) + bend(up, &ray[cell], down, i);
                    worst = worst.max(BETWEEN_RAYS as f32 * rays + BETWEEN_CELLS as f32 * turn);
                }
            }
            f64::from(worst)
        };
        (1..self.rays.len() - 1).map(own).collect()
    }
}

/// What may be left between each of the rays of a row within the frame and its neighbors, and between degrees of murkiness.
pub(super) fn left([above, own, below]: [&[Strip]; 3]) -> Vec<f64> {
    let columns = own[0].rays.len() - 2;
    let mut worst = vec![0.0f64; columns];
    for ((above, own), below) in above.iter().zip(own).zip(below) {
        for (worst, left) in worst.iter_mut().zip(own.left(above, below)) {
            *worst = worst.max(left);
        }
    }
    for (column, worst) in worst.iter_mut().enumerate() {
        let mut most = 0.0f32;
        for four in own.windows(4) {
            let [a, b, c, d] = [0, 1, 2, 3].map(|i| &four[i].rays[column + 1]);
            for cell in 0..CELLS {
                for i in 0..3 {
                    let [a, b, c, d] = [a, b, c, d].map(|ray| at_end(&ray[cell], i));
                    most = most.max((d - a + 3.0 * (b - c)).abs());
                }
            }
        }
        *worst += BETWEEN_DEGREES * f64::from(most);
    }
    worst
}

impl Frame<'_> {
    /// The rays of a row of blocks at every degree of murkiness; `columns` blocks have one ray more, and one on each side.
    pub(super) fn strips(&self, row: i64, columns: usize) -> Vec<Strip> {
        self.murkiness
            .degrees()
            .map(|path| self.strip(row, columns, path))
            .collect()
    }

    fn strip(&self, row: i64, columns: usize, path: f32) -> Strip {
        let [inverse_focal, cx, cy] = self.lens;
        let step = STEP as f32;
        // Its pixels are the rays, the first one block before the frame.
        let lens = [inverse_focal * step, cx / step + 1.0, cy / step - row as f32];
        let mut rays = vec![[[0.0f32; VALUES]; CELLS]; columns + 3];
        let mut distance = Vec::with_capacity(rays.len() + RUN);
        let (mut node, mut angles) = (SpreadNode::dark(), [0.0f32; RUN]);
        let murk = Murk {
            path: [path; RUN],
            ..Murk::default()
        };
        for (run, rays) in rays.chunks_mut(RUN).enumerate() {
            let mut directions = Rays::default();
            vectorized!(rays_of(
                lens,
                (run * RUN, 0),
                &[f32::INFINITY; RUN],
                &mut directions
            ));
            let (intervals, _) = vectorized!(whole(self.lamp, &directions, &murk));
            // In meters of water, not of mean water.
            distance.extend(intervals.distance.map(|meters| meters / path.max(1e-6)));
            let mut sums = [[0.0f32; RUN]; 3];
            for cell in 0..CELLS {
                let pair = [-NODE, NODE].map(|side| {
                    let share = (cell as f32 + 0.5 + side) * (2.0 / CELLS as f32);
                    vectorized!(angles_of(&intervals, share, &mut angles));
                    node.shine(self.lamp, &intervals, &angles);
                    node.light
                });
                for (i, ray) in rays.iter_mut().enumerate() {
                    let values = &mut ray[cell];
                    for channel in 0..3 {
                        let gain = self.lamp.gain[channel] * (intervals.scale[i] * (1.0 / CELLS as f32));
                        let [first, second] = [gain * pair[0][channel][i], gain * pair[1][channel][i]];
                        values[channel] = sums[channel][i];
                        values[channel + 3] = first + second;
                        // Of a line through both nodes.
                        values[channel + 6] = (second - first) * SLOPE;
                        sums[channel][i] += first + second;
                    }
                }
            }
        }
        Strip { rays, distance }
    }
}
