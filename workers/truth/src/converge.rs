//! Doubles the paths of a frame until its error is small enough.

use std::ops::Range;

use crate::dice::MOST_PATHS;
use crate::estimate::{BATCHES, Estimate, LightPart, PixelSums};

/// Fewer paths miss rare bright light, and the scatter does not reveal it.
const LEAST_PATHS: u64 = 256;
/// The error of light with finite variance falls to 0.71 with twice the paths; a factor of at least this indicates a
/// heavy tail.
const SLOW: f64 = 0.85;

/// Required accuracy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Error of the median block relative to the frame's mean.
    pub target: f64,
    /// Pixels on a side of a block.
    pub block: usize,
    /// Limit on the paths of a pixel.
    pub most_paths: u64,
}

/// A traced frame.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvergedTruth {
    /// Its paths.
    pub estimate: Estimate,
    /// Whether the goal was reached before the limit on paths.
    pub is_converged: bool,
    /// Channels whose error falls slower than the root of the paths: a heavy tail, whose light is underestimated.
    pub is_slow: [bool; 3],
}

/// Doubles the paths of every pixel until the goal is reached: the median block within the target, and the mean of the
/// frame within the target of the mean with half the paths, since too few paths look converged and are too dark.
/// `trace` returns the sums of every pixel for a range of samples, row by row, or `None` to stop; without any sample
/// there is no truth.
pub fn converge(
    size: (usize, usize),
    goal: &Goal,
    mut trace: impl FnMut(Range<u64>) -> Option<Vec<PixelSums>>,
) -> Option<ConvergedTruth> {
    let most = goal.most_paths.clamp(BATCHES as u64, MOST_PATHS);
    let mut truth = ConvergedTruth {
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
        let before = [0, 1, 2].map(|channel| estimate.whole(channel, LightPart::All));
        let Some(more) = trace(estimate.paths..2 * estimate.paths) else {
            break;
        };
        estimate
            .pixels
            .iter_mut()
            .zip(&more)
            .for_each(|(pixel, more)| pixel.merge(more));
        estimate.paths *= 2;
        let after = [0, 1, 2].map(|channel| estimate.whole(channel, LightPart::All));
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
    use crate::estimate::Level;
    use crate::walk::PathTally;
    use imaging::random::Stream;

    fn pixels(light: impl Fn(u64) -> f64, samples: Range<u64>) -> Option<Vec<PixelSums>> {
        let mut pixel = PixelSums::NOTHING;
        for sample in samples {
            let orders = [[light(sample); 3], [0.0; 3], [0.0; 3]];
            pixel.add(
                [0, 1, 2],
                sample,
                PathTally {
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
        trace: impl FnMut(Range<u64>) -> Option<Vec<PixelSums>>,
    ) -> ConvergedTruth {
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
        let level = truth.estimate.pixel(0, 1, LightPart::All);
        let expected = (1.0 / 12.0 / truth.estimate.paths as f64).sqrt();
        assert!((level.mean - 0.5).abs() < 4.0 * expected);
        assert!((0.4..2.0).contains(&(level.error / expected)), "{level:?}");
        assert_eq!(truth.estimate.pixel(0, 1, LightPart::Scattered), Level::default());
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
        // Twice the paths add a path that is twice as bright.
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
}
