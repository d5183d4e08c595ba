//! Cumulative sums of light along rays that are some pixels apart in a row.

use std::ops::Range;

use imaging::simd::{larger, smaller};
use imaging::vectorized;

use super::super::intervals::Rays;
use super::super::{Glow, Lanes, RUN};
use super::beside::{Bundle, Direct, Node};
use super::{BETWEEN_CELLS, Cut, Frame, WITHIN_CELL, nodes};

/// Where the two Gauss–Legendre nodes of a cell are.
const NODES: [f32; 2] = [0.211_324_87, 0.788_675_1];
/// Slope of a line, divided by its rise between them.
const RISE: f32 = 1.732_050_8;

/// A cell of a ray. Every four lanes hold three channels each: the sum up to the cell, in it, the slope there, and the sum up to
/// its end. The last lane is the largest third difference of the spread light up to the cell: the difference of two successive
/// changes of its slope.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Cell(pub(super) [f32; 16]);

/// Where in a cell these begin.
pub(super) const INSIDE: usize = 4;
pub(super) const SLOPE: usize = 8;
const END: usize = 12;
const BUMPS: usize = 15;

/// The cells of one ray.
#[derive(Clone, Copy)]
pub(super) struct Ray<'a> {
    cells: &'a [Cell],
    stride: usize,
    /// The first cell that was kept.
    start: usize,
}

impl<'a> Ray<'a> {
    #[inline(always)]
    pub(super) fn at(&self, cell: usize) -> &'a [f32; 16] {
        &self.cells[(cell - self.start) * self.stride].0
    }

    /// The sum up to the end of a cell; the fourth lane is unused.
    #[inline(always)]
    pub(super) fn end(&self, cell: usize) -> [f32; 4] {
        let at = self.at(cell);
        [at[END], at[END + 1], at[END + 2], at[BUMPS]]
    }

    /// The sum up to the start of a cell.
    #[inline(always)]
    pub(super) fn start(&self, cell: usize) -> [f32; 3] {
        let at = self.at(cell);
        [at[0], at[1], at[2]]
    }

    /// Largest third difference up to a cell.
    pub(super) fn bumps(&self, cell: usize) -> f32 {
        self.at(cell)[BUMPS]
    }
}

/// The rays of a row, from one before the frame to one behind it, in water of each degree of turbidity.
pub(super) struct Line {
    /// Slot of each ray among the needed ones.
    slots: Vec<usize>,
    /// How far the lamp is from each of these, m.
    distance: Vec<f32>,
    /// Cell by cell those of its rays, of each degree.
    degrees: Vec<Vec<Cell>>,
    cut: Cut,
    /// Bounds of the turbidity of its rays.
    pub(super) murk: nodes::Span,
}

impl Line {
    /// The rays of every `step`-th pixel of rows `row · step` that are `needed`, the first of them `step` pixels before the frame.
    /// All rows are integrated together, since one row would hardly fill the vectors.
    pub(super) fn of_rows(
        frame: &Frame<'_>,
        (step, rows): (usize, Range<i64>),
        cut: Cut,
        needed: &[bool],
    ) -> Vec<Self> {
        let asked: Vec<usize> = (0..needed.len()).filter(|&ray| needed[ray]).collect();
        let mut slots = vec![usize::MAX; needed.len()];
        for (slot, &ray) in asked.iter().enumerate() {
            slots[ray] = slot;
        }
        let dark = || vec![Cell([0.0; 16]); asked.len() * (cut.used - cut.first)];
        let line = |_| Self {
            slots: slots.clone(),
            distance: vec![0.0; asked.len()],
            degrees: (0..frame.murkiness.degrees()).map(|_| dark()).collect(),
            cut,
            murk: nodes::Span::dark(),
        };
        let mut lines: Vec<Self> = rows.clone().map(line).collect();
        let all = (0..lines.len()).flat_map(|line| (0..asked.len()).map(move |slot| (line, slot)));
        let all: Vec<(usize, usize)> = all.collect();
        let (mut bundle, step) = (Bundle::new(), step as f32);
        for run in all.chunks(RUN) {
            let mut rays = Rays::default();
            for (i, &(line, slot)) in run.iter().enumerate() {
                let row = (rows.start + line as i64) as f32;
                let place = ((asked[slot] as f32 - 1.0) * step, row * step);
                rays.aim(frame.lens, i, place, f32::INFINITY);
            }
            for degree in 0..frame.murkiness.degrees() {
                let murk = frame.murk_of(degree, &rays);
                vectorized!(bundle.aim(frame.lamp, &rays, &murk));
                for line in &mut lines[run[0].0..=run[run.len() - 1].0] {
                    line.murk.include(&murk, run.len());
                }
                let store = |i: usize, cell: usize, value: Cell| {
                    let (line, slot) = run[i];
                    lines[line].degrees[degree][(cell - cut.first) * asked.len() + slot] = value;
                };
                sum_up(frame.lamp, (&bundle, &murk.source), cut, run.len(), store);
            }
            for (i, &(line, slot)) in run.iter().enumerate() {
                lines[line].distance[slot] = bundle.meters[i];
            }
        }
        lines
    }

    /// A ray in water of each degree.
    pub(super) fn ray(&self, ray: usize) -> impl Iterator<Item = Ray<'_>> {
        let first = self.slots[ray];
        self.degrees.iter().map(move |cells| Ray {
            cells: &cells[first..],
            stride: self.distance.len(),
            start: self.cut.first,
        })
    }

    /// A ray in water of one degree.
    pub(super) fn in_degree(&self, ray: usize, degree: usize) -> Ray<'_> {
        Ray {
            cells: &self.degrees[degree][self.slots[ray]..],
            stride: self.distance.len(),
            start: self.cut.first,
        }
    }

    /// Number of degrees of turbidity of its rays.
    pub(super) fn count(&self) -> usize {
        self.degrees.len()
    }

    /// The next cell, or the last one.
    pub(super) fn next(&self, cell: usize) -> usize {
        (cell + 1).min(self.cut.used - 1)
    }

    pub(super) fn distance_m(&self, ray: usize) -> f32 {
        self.distance[self.slots[ray]]
    }

    /// Quadrature error of these cells of all rays, and of those before, beyond a share of the light up to them.
    pub(super) fn left_by_cells(&self, cells: (usize, usize), share: f32) -> f64 {
        let next = (cells.0, self.next(cells.1));
        let asked = (0..self.slots.len()).filter(|&ray| self.slots[ray] != usize::MAX);
        let left = asked.flat_map(|ray| self.ray(ray)).map(|ray| {
            let [r, g, b] = ray.start(cells.0);
            let least = smaller(smaller(r, g), b);
            BETWEEN_CELLS * ray.bumps(next.1) + WITHIN_CELL * turns(ray, next) - share * least
        });
        f64::from(left.fold(0.0, f32::max))
    }
}

/// A cell of a run of rays.
struct Across {
    sums: [Lanes; 3],
    inside: [Lanes; 3],
    slope: [Lanes; 3],
    /// Of the spread light.
    spread: [Lanes; 3],
    turn: [Lanes; 3],
    bumps: Lanes,
}

impl Across {
    fn dark() -> Self {
        let dark = [[0.0; RUN]; 3];
        Self {
            sums: dark,
            inside: dark,
            slope: dark,
            spread: dark,
            turn: dark,
            bumps: [0.0; RUN],
        }
    }

    /// Advances to the next cell, whose nodes have this light.
    #[inline(always)]
    fn go_on(
        &mut self,
        gain: [f32; 3],
        scale: &Lanes,
        [one, other]: [&Node; 2],
        direct: &Direct,
        cell: usize,
    ) {
        let [shown_turn, shown_bump] = [1, 2].map(|least| if cell >= least { 1.0 } else { 0.0 });
        for channel in 0..3 {
            let (sums, inside) = (&mut self.sums[channel], &mut self.inside[channel]);
            let (slope, spread) = (&mut self.slope[channel], &mut self.spread[channel]);
            let turn = &mut self.turn[channel];
            let [one, other] = [&one.light[channel], &other.light[channel]];
            let [direct_one, direct_other] = [&direct.0[0][channel], &direct.0[1][channel]];
            for i in 0..RUN {
                let gain = gain[channel] * scale[i];
                // Of a line through both nodes.
                let next = gain * (other[i] - one[i]) * RISE;
                let next_turn = shown_turn * (next - spread[i]);
                let bump = shown_bump * (next_turn - turn[i]).abs();
                self.bumps[i] = if bump > self.bumps[i] { bump } else { self.bumps[i] };
                (spread[i], turn[i]) = (next, next_turn);
                sums[i] += inside[i];
                inside[i] = gain * ((one[i] + other[i]) + (direct_one[i] + direct_other[i]));
                slope[i] = next + gain * (direct_other[i] - direct_one[i]) * RISE;
            }
        }
    }
}

/// Integrates the first `count` rays of a run, and stores their cells.
fn sum_up(
    lamp: &Glow,
    (rays, source): (&Bundle, &Lanes),
    cut: Cut,
    count: usize,
    mut store: impl FnMut(usize, usize, Cell),
) {
    let ([mut one, mut other], mut direct) = ([Node::dark(), Node::dark()], Direct::dark());
    let mut scale = [0.0f32; RUN];
    for i in 0..RUN {
        scale[i] = source[i] * rays.start[i] / (2.0 * cut.cells as f32 * rays.meters[i]);
    }
    let mut across = Across::dark();
    for cell in 0..cut.used {
        let share = |place: f32| 1.0 - (cell as f32 + place) / cut.cells as f32;
        one.shine(lamp, rays, share(NODES[0]));
        other.shine(lamp, rays, share(NODES[1]));
        if lamp.profile.slope > 0.0 {
            let ends = [share(0.0), share(1.0)];
            vectorized!(direct.shine(lamp, rays, ends, NODES));
        }
        vectorized!(across.go_on(lamp.gain, &scale, [&one, &other], &direct, cell));
        if cell < cut.first {
            continue;
        }
        let Across {
            sums: [sr, sg, sb],
            inside: [ir, ig, ib],
            slope: [lr, lg, lb],
            bumps,
            ..
        } = &across;
        for i in 0..count {
            let [r, g, b] = [sr[i] + ir[i], sg[i] + ig[i], sb[i] + ib[i]];
            store(
                i,
                cell,
                Cell([
                    sr[i], sg[i], sb[i], 0.0, ir[i], ig[i], ib[i], 0.0, lr[i], lg[i], lb[i], 0.0, r, g, b,
                    bumps[i],
                ]),
            );
        }
    }
}

/// Largest change of the slope next to or between some cells.
pub(super) fn turns(own: Ray<'_>, (first, last): (usize, usize)) -> f32 {
    let mut worst = 0.0f32;
    for cell in first.max(1)..=last {
        for i in SLOPE..SLOPE + 3 {
            worst = larger((own.at(cell)[i] - own.at(cell - 1)[i]).abs(), worst);
        }
    }
    worst
}

/// The greatest third difference.
pub(super) fn between_degrees(four: &[Ray<'_>], (first, last): (usize, usize)) -> f32 {
    let mut worst = [0.0f32; 4];
    for cell in first.saturating_sub(1)..=last {
        let [a, b, c, d] = [0, 1, 2, 3].map(|degree| four[degree].end(cell));
        for i in 0..4 {
            worst[i] = larger((d[i] - a[i] + 3.0 * (b[i] - c[i])).abs(), worst[i]);
        }
    }
    larger(larger(worst[0], worst[1]), worst[2])
}
