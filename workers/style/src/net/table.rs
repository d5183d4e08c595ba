//! The network as a color table: the cheap variant for waters whose network is nearly a color map.
//!
//! A table of 17³ colors is fitted to the network's output for given pictures; frames are looked up by tetrahedral
//! interpolation (Kasson, Nin, Plouffe and Hafner 1995). It ignores surroundings: softening and haze around edges are
//! averaged away.

mod look_up;
mod swatches;

use imaging::Rgb;

use super::fast::{Network, Scratch};

pub use look_up::TableScratch;

/// Nodes along each axis.
const NODES: usize = 17;
/// Index steps to the next node along red, green and blue.
const STEPS: [usize; 3] = [NODES * NODES, NODES, 1];
/// Rounds of correction by the residual.
const ROUNDS: usize = 12;
/// Weight of the response to flat frames, in pixels: it determines colors absent from the pictures.
const FLAT_WEIGHT: f32 = 4.0;

/// A color table: node `(r, g, b)` is at `(r * 17 + g) * 17 + b`, with a fourth number for alignment.
#[derive(Debug, Clone, PartialEq)]
pub struct ColorTable {
    nodes: Vec<[f32; 4]>,
}

impl ColorTable {
    /// The table of a network: a pure function of it. `None` for a network with a range, which a table of colors lacks.
    #[must_use]
    pub fn new(network: &Network) -> Option<Self> {
        if network.takes_range() {
            return None;
        }
        let mut scratch = Scratch::default();
        let pairs: Vec<_> = swatches::swatches()
            .map(|before| {
                let after = network.apply(&before, None, &mut scratch);
                (before, after)
            })
            .collect();
        let nodes = (0..NODES * NODES * NODES).map(|index| {
            let flat = Rgb::from_fn(1, 1, |_, _| color_of(index));
            network.apply(&flat, None, &mut scratch).pixel(0, 0)
        });
        let flat: Vec<[f32; 3]> = nodes.collect();
        Some(Self::fit(&pairs, &flat))
    }

    /// Fits a table to pictures before and after. `flat` is the response to a frame of each node's color.
    fn fit(pairs: &[(Rgb<f32>, Rgb<f32>)], flat: &[[f32; 3]]) -> Self {
        let mut table = Self {
            nodes: flat.iter().map(|&[r, g, b]| [r, g, b, 0.0]).collect(),
        };
        for _ in 0..ROUNDS {
            table.improve(pairs);
        }
        table
    }

    /// Moves each node by the mean residual around it.
    fn improve(&mut self, pairs: &[(Rgb<f32>, Rgb<f32>)]) {
        let mut sums = vec![[0.0f32; 4]; self.nodes.len()];
        for (before, after) in pairs {
            for y in 0..before.height() {
                for x in 0..before.width() {
                    let (places, shares) = corners(before.pixel(x, y));
                    let now = self.mixed(places, shares);
                    let wanted = after.pixel(x, y);
                    for (place, share) in places.into_iter().zip(shares) {
                        for channel in 0..3 {
                            sums[place][channel] += share * (wanted[channel] - now[channel]);
                        }
                        sums[place][3] += share;
                    }
                }
            }
        }
        for (node, sum) in self.nodes.iter_mut().zip(sums) {
            for channel in 0..3 {
                node[channel] = (node[channel] + sum[channel] / (sum[3] + FLAT_WEIGHT)).clamp(0.0, 1.0);
            }
        }
    }

    /// The color of [`ColorTable::apply`] for one pixel, in the order of the formula.
    #[must_use]
    pub fn look_up(&self, color: [f32; 3]) -> [f32; 3] {
        let (places, shares) = corners(color);
        self.mixed(places, shares)
    }

    fn mixed(&self, places: [usize; 4], shares: [f32; 4]) -> [f32; 3] {
        [0, 1, 2].map(|channel| {
            (0..4)
                .map(|at| self.nodes[places[at]][channel] * shares[at])
                .sum()
        })
    }
}

/// The color of a node.
fn color_of(index: usize) -> [f32; 3] {
    let places = [index / (NODES * NODES), index / NODES % NODES, index % NODES];
    places.map(|place| place as f32 / (NODES - 1) as f32)
}

/// The corners of the tetrahedron around a color, and their weights. Colors outside of 0..=1 are clamped.
fn corners(color: [f32; 3]) -> ([usize; 4], [f32; 4]) {
    let mut base = 0;
    let mut inside = [(0.0f32, 0); 3];
    for axis in 0..3 {
        let place = color[axis].clamp(0.0, 1.0) * (NODES - 1) as f32;
        let cell = (place as usize).min(NODES - 2);
        base += cell * STEPS[axis];
        inside[axis] = (place - cell as f32, STEPS[axis]);
    }
    // Along the axes in descending order of weight; the order of ties does not change the color.
    inside.sort_by(|one, other| other.0.total_cmp(&one.0));
    let [(u, first), (v, second), (w, third)] = inside;
    (
        [
            base,
            base + first,
            base + first + second,
            base + first + second + third,
        ],
        [1.0 - u, u - v, v - w, w],
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(map: impl Fn([f32; 3]) -> [f32; 3]) -> Vec<[f32; 3]> {
        (0..NODES * NODES * NODES)
            .map(|node| map(color_of(node)))
            .collect()
    }

    /// A table reproduces an affine map.
    #[test]
    fn an_affine_map_is_met_everywhere() {
        let map = |[r, g, b]: [f32; 3]| [0.1 + 0.5 * g, 0.2 + 0.3 * r + 0.2 * b, 0.9 - 0.7 * b];
        let picture = Rgb::from_fn(24, 24, |x, y| {
            [x as f32 / 23.0, y as f32 / 23.0, (x * y % 24) as f32 / 23.0]
        });
        let after = Rgb::from_fn(24, 24, |x, y| map(picture.pixel(x, y)));
        let table = ColorTable::fit(&[(picture, after)], &flat(map));
        for index in 0..1000 {
            let color = [7, 11, 13].map(|step| (index * step % 1000) as f32 / 999.0);
            for (found, expected) in table.look_up(color).into_iter().zip(map(color)) {
                assert!(
                    (found - expected).abs() < 1e-5,
                    "{color:?}: {found} is not {expected}"
                );
            }
        }
    }

    #[test]
    fn pictures_decide_over_flat_frames_where_there_are_any() {
        let picture = Rgb::from_fn(40, 40, |_, _| [0.5f32; 3]);
        let after = picture.map(|_| 0.8);
        let table = ColorTable::fit(&[(picture, after)], &flat(|_| [0.2; 3]));
        assert!((table.look_up([0.5; 3])[0] - 0.8).abs() < 1e-3);
        assert_eq!(table.look_up([0.0, 1.0, 0.0]), [0.2; 3]);
    }
}
