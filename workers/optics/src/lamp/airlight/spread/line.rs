//! Sums of spread light along rays that lie some pixels apart in a row.

use imaging::vectorized;

use super::super::integrand::SpreadNode;
use super::super::intervals::{Intervals, Murk, Rays};
use super::super::{Glow, RUN};
use super::{BETWEEN_CELLS, BETWEEN_DEGREES, BETWEEN_RAYS, Frame, angles_of, whole};

/// Half the distance of the two Gauss–Legendre nodes in a cell, in cells.
const NODE: f32 = 0.288_675_13;
/// The slope of a line by what it rises between them.
const SLOPE: f32 = 1.732_050_8;

/// Of an angle of a ray: the sum up to it, in it, and its slope there, of three channels; the fourth fills a vector.
pub(super) type Cell = [[f32; 4]; 3];

/// The rays of a row, from one before the frame to one behind it, in water of each degree of murkiness.
pub(super) struct Line {
    /// Where each ray stands among those that were asked for.
    slots: Vec<usize>,
    /// How far the lamp is from each of these, m.
    distance: Vec<f32>,
    degrees: Vec<Vec<Cell>>,
    cells: usize,
}

impl Line {
    /// The rays of every `step`-th pixel of row `row · step` that are `needed`, the first of them `step` pixels before the frame.
    pub(super) fn new(frame: &Frame<'_>, (step, row): (usize, i64), cells: usize, needed: &[bool]) -> Self {
        let mut line = Self {
            slots: vec![usize::MAX; needed.len()],
            distance: Vec::new(),
            degrees: vec![Vec::new(); frame.murkiness.degrees().len()],
            cells,
        };
        let asked: Vec<usize> = (0..needed.len()).filter(|&ray| needed[ray]).collect();
        for (slot, &ray) in asked.iter().enumerate() {
            line.slots[ray] = slot;
        }
        for all in &mut line.degrees {
            all.reserve_exact(asked.len() * cells);
        }
        let step = step as f32;
        for run in asked.chunks(RUN) {
            let mut rays = Rays::default();
            for (i, &ray) in run.iter().enumerate() {
                let place = ((ray as f32 - 1.0) * step, row as f32 * step);
                rays.aim(frame.lens, i, place, f32::INFINITY);
            }
            for (degree, path) in frame.murkiness.degrees().enumerate() {
                let murk = Murk {
                    path: [path; RUN],
                    ..Murk::default()
                };
                let (intervals, _) = vectorized!(whole(frame.lamp, &rays, &murk));
                if degree == 0 {
                    // In meters of water, not of mean water.
                    let meters = intervals.distance[..run.len()].iter();
                    line.distance.extend(meters.map(|meters| meters / path.max(1e-6)));
                }
                sum_up(
                    frame.lamp,
                    &intervals,
                    cells,
                    run.len(),
                    &mut line.degrees[degree],
                );
            }
        }
        line
    }

    /// The cells of a ray in water of each degree.
    pub(super) fn ray(&self, ray: usize) -> impl Iterator<Item = &[Cell]> {
        let first = self.slots[ray] * self.cells;
        self.degrees
            .iter()
            .map(move |all| &all[first..first + self.cells])
    }

    pub(super) fn distance_m(&self, ray: usize) -> f32 {
        self.distance[self.slots[ray]]
    }

    /// What may be left between a ray and its neighbors, those in the rows above and below among them, and between degrees of
    /// murkiness.
    pub(super) fn left(&self, ray: usize, above: &Self, below: &Self) -> f64 {
        let mut worst = 0.0f32;
        let beside = self.ray(ray - 1).zip(self.ray(ray + 1));
        for ((own, beside), across) in self.ray(ray).zip(beside).zip(above.ray(ray).zip(below.ray(ray))) {
            worst = worst.max(vectorized!(between_rays(own, beside, across)));
        }
        let degrees: Vec<&[Cell]> = self.ray(ray).collect();
        let mut bent = 0.0f32;
        for four in degrees.windows(4) {
            bent = bent.max(vectorized!(between_degrees(four)));
        }
        f64::from(worst + BETWEEN_DEGREES * bent)
    }
}

/// Appends the cells of the first `count` rays of a run.
fn sum_up(lamp: &Glow, to: &Intervals, cells: usize, count: usize, all: &mut Vec<Cell>) {
    let first = all.len();
    all.resize(first + count * cells, Cell::default());
    let (mut node, mut angles) = (SpreadNode::dark(), [0.0f32; RUN]);
    let mut sums = [[0.0f32; RUN]; 3];
    for cell in 0..cells {
        let pair = [-NODE, NODE].map(|side| {
            let halves = (cell as f32 + 0.5 + side) * (2.0 / cells as f32);
            vectorized!(angles_of(to, halves, &mut angles));
            node.shine(lamp, to, &angles);
            node.light
        });
        for (i, ray) in all[first..].chunks_mut(cells).enumerate() {
            let [start, inside, slope] = &mut ray[cell];
            for channel in 0..3 {
                let gain = lamp.gain[channel] * (to.scale[i] * (1.0 / cells as f32));
                let [one, other] = [gain * pair[0][channel][i], gain * pair[1][channel][i]];
                start[channel] = sums[channel][i];
                inside[channel] = one + other;
                // Of a line through both nodes.
                slope[channel] = (other - one) * SLOPE;
                sums[channel][i] += one + other;
            }
        }
    }
}

/// The sum up to the end of a cell.
#[inline(always)]
fn at_end([start, inside, _]: &Cell) -> [f32; 4] {
    std::array::from_fn(|i| start[i] + inside[i])
}

#[inline(always)]
fn between_rays(own: &[Cell], (left, right): (&[Cell], &[Cell]), (up, down): (&[Cell], &[Cell])) -> f32 {
    let mut worst = [0.0f32; 4];
    let mut before = own[0][2];
    for ((((own, left), right), up), down) in own.iter().zip(left).zip(right).zip(up).zip(down) {
        let [middle, left, right, up, down] = [own, left, right, up, down].map(at_end);
        for i in 0..4 {
            let bends =
                (left[i] - 2.0 * middle[i] + right[i]).abs() + (up[i] - 2.0 * middle[i] + down[i]).abs();
            let turns = (own[2][i] - before[i]).abs();
            worst[i] = worst[i].max(BETWEEN_RAYS * bends + BETWEEN_CELLS * turns);
        }
        before = own[2];
    }
    worst.into_iter().fold(0.0, f32::max)
}

/// The greatest third difference.
#[inline(always)]
fn between_degrees(four: &[&[Cell]]) -> f32 {
    let mut worst = [0.0f32; 4];
    for (((a, b), c), d) in four[0].iter().zip(four[1]).zip(four[2]).zip(four[3]) {
        let [a, b, c, d] = [a, b, c, d].map(at_end);
        for i in 0..4 {
            worst[i] = worst[i].max((d[i] - a[i] + 3.0 * (b[i] - c[i])).abs());
        }
    }
    worst.into_iter().fold(0.0, f32::max)
}
