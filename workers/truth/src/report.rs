//! A frame's truth beside the chain's light, as a report.

use imaging::{Plane, Rgb};
use serde::Serialize;

use crate::compare::Comparison;
use crate::converge::{Goal, Truth};
use crate::estimate::{Level, Part, Spread};

/// The chain's light of a frame, linear, without daylight's veil.
#[derive(Debug, Clone, Copy)]
pub struct ChainLight<'a> {
    /// Light that arrives unscattered.
    pub direct: &'a Rgb<f32>,
    /// Light that arrives scattered: of surfaces and of lamps.
    pub scattered: &'a Rgb<f32>,
}

/// What was traced, how well it is known, and how far the chain is from it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Paths of each pixel and channel.
    pub paths: u64,
    /// Whether the target was met before the paths ran out.
    pub converged: bool,
    /// Target for the error of the median block, as a share of the mean.
    pub target: f64,
    /// Pixels on a side of a block.
    pub block: usize,
    /// Paths that a limit ended; their light is too little.
    pub cut: u64,
    /// Channels, red, green, blue, whose error falls slower than with the root of the paths: their light is still too little.
    pub heavy_tail: [bool; 3],
    /// Mean of the frame and its error, red, green, blue.
    pub mean: [Level; 3],
    /// Errors of the blocks.
    pub block_error: [Spread; 3],
    /// The chain held against it, by how often the water scattered the light.
    pub chain: Parts,
    /// Where the truth has its surfaces from.
    pub rays: &'static str,
    /// What neither holds.
    pub left_out: &'static [&'static str],
}

/// Comparisons of parts of the light.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Parts {
    /// Never scattered: the chain's direct light.
    pub unscattered: Comparison,
    /// Scattered: the chain's forward scatter and glow.
    pub scattered: Comparison,
    /// All of it.
    pub all: Comparison,
}

const LEFT_OUT: &[&str] = &["veil of daylight", "snow", "style", "haze", "camera"];

impl Report {
    /// Holds the chain's light against the truth of the same frame.
    #[must_use]
    pub fn new(truth: &Truth, goal: &Goal, chain: &ChainLight<'_>, range: Option<&Plane<f32>>) -> Self {
        let estimate = &truth.estimate;
        let compare = |light: &Rgb<f32>, part| Comparison::new(light, estimate, part, range, goal.block);
        let all = Rgb::from_fn(estimate.size.0, estimate.size.1, |x, y| {
            [0, 1, 2].map(|i| chain.direct.planes()[i].pixel(x, y) + chain.scattered.planes()[i].pixel(x, y))
        });
        Self {
            paths: estimate.paths,
            converged: truth.is_converged,
            target: goal.target,
            block: goal.block,
            cut: estimate.cut(),
            heavy_tail: truth.is_slow,
            mean: [0, 1, 2].map(|i| estimate.whole(i, Part::All)),
            block_error: [0, 1, 2].map(|i| estimate.spread(goal.block, i)),
            chain: Parts {
                unscattered: compare(chain.direct, Part::Unscattered),
                scattered: compare(chain.scattered, Part::Scattered),
                all: compare(&all, Part::All),
            },
            rays: "screen",
            left_out: LEFT_OUT,
        }
    }
}

impl Truth {
    /// Means of the pixels, and their standard errors.
    #[must_use]
    pub fn pictures(&self) -> [Rgb<f32>; 2] {
        let (width, height) = self.estimate.size;
        let level = |x: usize, y: usize, i| self.estimate.pixel(y * width + x, i, Part::All);
        [
            Rgb::from_fn(width, height, |x, y| {
                [0, 1, 2].map(|i| level(x, y, i).mean as f32)
            }),
            Rgb::from_fn(width, height, |x, y| {
                [0, 1, 2].map(|i| level(x, y, i).error as f32)
            }),
        ]
    }
}
