//! What many paths say: means, their standard errors, and when they are known well enough.

use std::ops::Range;

use imaging::cancel;
use imaging::random::Stream;
use serde::Serialize;

use crate::dice::{Address, MOST_PATHS};
use crate::scene::{Along, Scene};
use crate::walk::{ORDERS, Tally};

/// Equal batches of the paths of a pixel, from whose scatter the error follows.
pub const BATCHES: usize = 16;
/// With fewer paths, rare and bright light is missed and the scatter does not show it.
const LEAST_PATHS: u64 = 256;
/// The error of light with a variance falls to 0.71 with twice the paths; what falls to no less than this has a heavy tail.
const SLOW: f64 = 0.85;

/// A mean and its standard error.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Level {
    /// The mean.
    pub mean: f64,
    /// Its standard error.
    pub error: f64,
}

/// Which light: by how often the water scattered it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Never.
    Unscattered,
    /// Once or more often.
    Scattered,
    /// All.
    All,
}

impl Part {
    fn orders(self) -> Range<usize> {
        match self {
            Self::Unscattered => 0..1,
            Self::Scattered => 1..ORDERS,
            Self::All => 0..ORDERS,
        }
    }
}

/// The paths of a pixel, summed by channel, order and batch.
#[derive(Debug, Clone, PartialEq)]
pub struct Pixel {
    sums: [[[f64; BATCHES]; ORDERS]; 3],
    /// Paths that a limit ended.
    pub cut: u64,
}

impl Pixel {
    const NOTHING: Self = Self {
        sums: [[[0.0; BATCHES]; ORDERS]; 3],
        cut: 0,
    };

    /// Traces some of the paths of a pixel. `shared` takes all channels on one path.
    #[must_use]
    pub fn trace(
        scene: &Scene<'_>,
        along: Along,
        stream: Stream,
        at: Address,
        samples: Range<u64>,
        shared: bool,
    ) -> Self {
        let mut pixel = Self::NOTHING;
        for sample in samples {
            if sample % 64 == 0 {
                cancel::check();
            }
            if shared {
                let address = Address { sample, ..at };
                pixel.add([0, 1, 2], sample, scene.trace_shared(along, stream, address));
                continue;
            }
            for channel in 0..3 {
                let address = Address {
                    sample,
                    channel: channel as u64,
                    ..at
                };
                pixel.add([channel], sample, scene.trace(along, stream, address));
            }
        }
        pixel
    }

    fn add<const N: usize>(&mut self, channels: [usize; N], sample: u64, tally: Tally<N>) {
        let batch = (sample % BATCHES as u64) as usize;
        for (i, channel) in channels.into_iter().enumerate() {
            for (order, light) in tally.orders.iter().enumerate() {
                self.sums[channel][order][batch] += light[i];
            }
        }
        self.cut += u64::from(tally.is_cut);
    }

    fn merge(&mut self, other: &Self) {
        let pairs = self
            .sums
            .iter_mut()
            .flatten()
            .flatten()
            .zip(other.sums.iter().flatten().flatten());
        pairs.for_each(|(sum, more)| *sum += more);
        self.cut += other.cut;
    }

    /// Mean and error of a channel after this many paths.
    fn level(&self, paths: u64, channel: usize, part: Part) -> Level {
        let share = BATCHES as f64 / paths as f64;
        let batches: [f64; BATCHES] = std::array::from_fn(|k| {
            share
                * part
                    .orders()
                    .map(|order| self.sums[channel][order][k])
                    .sum::<f64>()
        });
        level(&batches)
    }
}

/// Mean of batches and its standard error.
pub(crate) fn level(batches: &[f64]) -> Level {
    let n = batches.len() as f64;
    let mean = batches.iter().sum::<f64>() / n;
    let square = batches.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
    Level {
        mean,
        error: (square / n).sqrt(),
    }
}

/// A frame cut into squares, those at its right and lower edge smaller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Blocks {
    /// Columns and rows of the frame.
    pub size: (usize, usize),
    /// Pixels on a side of a square.
    pub side: usize,
}

impl Blocks {
    /// The pixels of each square, by their numbers row by row.
    pub fn each(self) -> impl Iterator<Item = Vec<usize>> {
        let (width, height) = self.size;
        let corners = (0..height).step_by(self.side);
        let corners = corners.flat_map(move |y| (0..width).step_by(self.side).map(move |x| (x, y)));
        corners.map(move |(left, top)| {
            let rows = top..(top + self.side).min(height);
            let columns = left..(left + self.side).min(width);
            rows.flat_map(|y| columns.clone().map(move |x| y * width + x))
                .collect()
        })
    }
}

/// The paths of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Columns and rows.
    pub size: (usize, usize),
    /// Paths of each pixel.
    pub paths: u64,
    pixels: Vec<Pixel>,
}

/// How the errors of blocks spread.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Half of the blocks are known better.
    pub median: f64,
    /// All but one in twenty are known better.
    pub percentile_95: f64,
}

impl Estimate {
    /// Mean and error of a pixel.
    #[must_use]
    pub fn pixel(&self, pixel: usize, channel: usize, part: Part) -> Level {
        self.pixels[pixel].level(self.paths, channel, part)
    }

    /// Mean and error over some pixels, which are independent of each other.
    #[must_use]
    pub fn mean(&self, pixels: &[usize], channel: usize, part: Part) -> Level {
        let n = pixels.len() as f64;
        let levels = pixels.iter().map(|&pixel| self.pixel(pixel, channel, part));
        let (mean, square) = levels.fold((0.0, 0.0), |(mean, square), level| {
            (mean + level.mean, square + level.error * level.error)
        });
        Level {
            mean: mean / n,
            error: square.sqrt() / n,
        }
    }

    /// Mean and error of the frame.
    #[must_use]
    pub fn whole(&self, channel: usize, part: Part) -> Level {
        let all: Vec<usize> = (0..self.pixels.len()).collect();
        self.mean(&all, channel, part)
    }

    /// The errors of blocks.
    #[must_use]
    pub fn spread(&self, side: usize, channel: usize) -> Spread {
        let blocks = Blocks {
            size: self.size,
            side,
        };
        let mut errors: Vec<f64> = blocks
            .each()
            .map(|pixels| self.mean(&pixels, channel, Part::All).error)
            .collect();
        errors.sort_by(f64::total_cmp);
        let at = |share: f64| errors[((errors.len() - 1) as f64 * share).round() as usize];
        Spread {
            median: at(0.5),
            percentile_95: at(0.95),
        }
    }

    /// Paths that a limit ended.
    #[must_use]
    pub fn cut(&self) -> u64 {
        self.pixels.iter().map(|pixel| pixel.cut).sum()
    }
}

/// How well a frame must be known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Error of the median block as a share of the frame's mean.
    pub target: f64,
    /// Pixels on a side of a block.
    pub block: usize,
    /// Most paths of a pixel.
    pub most_paths: u64,
}

/// A frame traced toward a goal.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// Its paths.
    pub estimate: Estimate,
    /// Whether the goal was met before the paths ran out.
    pub is_converged: bool,
    /// Channels whose error falls slower than the root of the paths: a heavy tail, whose light is still too little.
    pub is_slow: [bool; 3],
}

/// Doubles the paths of every pixel until the goal is met: the median block known to the target, and the mean of the frame the same
/// as with half the paths to within the target, since too few paths look converged and are too dark. `trace` returns what the
/// samples of a range say of every pixel, row by row, and none where it will not go on; without any sample there is no truth.
pub fn converge(
    size: (usize, usize),
    goal: &Goal,
    mut trace: impl FnMut(Range<u64>) -> Option<Vec<Pixel>>,
) -> Option<Truth> {
    let most = goal.most_paths.clamp(BATCHES as u64, MOST_PATHS);
    let mut truth = Truth {
        estimate: Estimate {
            size,
            paths: BATCHES as u64,
            pixels: trace(0..BATCHES as u64)?,
        },
        is_converged: false,
        is_slow: [false; 3],
    };
    while !truth.is_converged && truth.estimate.paths * 2 <= most {
        let estimate = &mut truth.estimate;
        let before = [0, 1, 2].map(|channel| estimate.whole(channel, Part::All));
        let Some(more) = trace(estimate.paths..2 * estimate.paths) else {
            break;
        };
        estimate
            .pixels
            .iter_mut()
            .zip(&more)
            .for_each(|(pixel, more)| pixel.merge(more));
        estimate.paths *= 2;
        let after = [0, 1, 2].map(|channel| estimate.whole(channel, Part::All));
        truth.is_slow = [0, 1, 2].map(|i| after[i].error > SLOW * before[i].error);
        truth.is_converged = estimate.paths >= LEAST_PATHS
            && (0..3).all(|i| {
                let allowed = goal.target * after[i].mean;
                let holds = (after[i].mean - before[i].mean).abs() <= allowed;
                holds && estimate.spread(goal.block, i).median <= allowed
            });
    }
    Some(truth)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixels(light: impl Fn(u64) -> f64, samples: Range<u64>) -> Option<Vec<Pixel>> {
        let mut pixel = Pixel::NOTHING;
        for sample in samples {
            let orders = [[light(sample); 3], [0.0; 3], [0.0; 3]];
            pixel.add(
                [0, 1, 2],
                sample,
                Tally {
                    orders,
                    is_cut: false,
                },
            );
        }
        Some(vec![pixel; 6])
    }

    fn converged(
        size: (usize, usize),
        goal: &Goal,
        trace: impl FnMut(Range<u64>) -> Option<Vec<Pixel>>,
    ) -> Truth {
        converge(size, goal, trace).expect("a first round")
    }

    #[test]
    fn paths_are_doubled_until_the_blocks_and_the_mean_are_known() {
        let dice = Stream::stage(5, "truth");
        let goal = Goal {
            target: 0.02,
            block: 2,
            most_paths: 1 << 16,
        };
        let truth = converged((3, 2), &goal, |samples| {
            pixels(|sample| dice.unit(0, sample), samples)
        });
        assert!(truth.is_converged && truth.estimate.paths >= LEAST_PATHS);
        let level = truth.estimate.pixel(0, 1, Part::All);
        let expected = (1.0 / 12.0 / truth.estimate.paths as f64).sqrt();
        assert!((level.mean - 0.5).abs() < 4.0 * expected);
        assert!((0.4..2.0).contains(&(level.error / expected)), "{level:?}");
        assert_eq!(truth.estimate.pixel(0, 1, Part::Scattered), Level::default());
        let few = Goal {
            most_paths: 64,
            ..goal
        };
        let truth = converged((3, 2), &few, |samples| {
            pixels(|sample| dice.unit(0, sample), samples)
        });
        assert!(!truth.is_converged && truth.estimate.paths == 64);
    }

    #[test]
    fn light_with_a_heavy_tail_is_called_slow() {
        // Twice as many paths bring a path that is twice as bright.
        let rare = |sample: u64| {
            if (sample + 1).is_power_of_two() {
                (sample + 1) as f64
            } else {
                0.0
            }
        };
        let goal = Goal {
            target: 0.001,
            block: 1,
            most_paths: 1 << 12,
        };
        let truth = converged((3, 2), &goal, |samples| pixels(rare, samples));
        assert_eq!((truth.is_converged, truth.is_slow), (false, [true; 3]));
    }

    #[test]
    fn blocks_hold_every_pixel_once() {
        let blocks = Blocks {
            size: (5, 3),
            side: 2,
        };
        let mut all: Vec<usize> = blocks.each().flatten().collect();
        all.sort_unstable();
        assert_eq!(all, (0..15).collect::<Vec<_>>());
        assert_eq!(blocks.each().next(), Some(vec![0, 1, 5, 6]));
    }
}
