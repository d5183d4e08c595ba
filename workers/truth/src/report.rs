//! TruthReport on a frame's truth and the chain's distance from it.

use imaging::{Plane, Rgb};
use serde::Serialize;

use crate::compare::Comparison;
use crate::converge::{ConvergedTruth, Goal};
use crate::estimate::{ErrorSpread, Level, LightPart};
use crate::phase_model::PhaseModel;

/// The chain's light of a frame, linear.
#[derive(Debug, Clone, Copy)]
pub struct ChainLight<'a> {
    /// Unscattered light.
    pub direct: &'a Rgb<f32>,
    /// Scattered light: of surfaces, of lamps and, if traced, of daylight.
    pub scattered: &'a Rgb<f32>,
}

/// Parameters of the run, and its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReportRequest {
    /// Required accuracy.
    pub goal: Goal,
    /// Phase function.
    pub law: PhaseModel,
    /// Source of the surfaces: `scene` or `screen`.
    pub rays: &'static str,
    /// Whether daylight was traced; the chain's scattered light must then include it.
    pub has_sea: bool,
    /// Limit that ended it short of the target.
    pub limit: &'static str,
}

/// Parameters, accuracy and the chain's distance from the truth.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TruthReport {
    /// Paths of each pixel and channel.
    pub paths: u64,
    /// Whether the target was reached before the limit on paths.
    pub converged: bool,
    /// `target`, or the first limit reached.
    pub ended_by: &'static str,
    /// Phase function.
    pub phase: PhaseModel,
    /// Target for the error of the median block, relative to the mean.
    pub target: f64,
    /// Pixels on a side of a block.
    pub block: usize,
    /// Paths ended by a limit; their light is underestimated.
    pub cut: u64,
    /// Channels, red, green, blue, whose error falls slower than the root of the paths: their light is underestimated.
    pub heavy_tail: [bool; 3],
    /// Mean of the frame and its error, red, green, blue.
    pub mean: [Level; 3],
    /// Errors of the blocks.
    pub block_error: [ErrorSpread; 3],
    /// Comparison with the chain by the number of scattering events.
    pub chain: PartComparisons,
    /// Source of the surfaces.
    pub rays: &'static str,
    /// Effects missing from both.
    pub left_out: Vec<&'static str>,
}

/// Comparisons of parts of the light.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartComparisons {
    /// Unscattered: the chain's direct light.
    pub unscattered: Comparison,
    /// Scattered: the chain's forward scatter and airlight.
    pub scattered: Comparison,
    /// All light.
    pub all: Comparison,
}

const LEFT_OUT: [&str; 4] = ["snow", "style", "haze", "camera"];

impl TruthReport {
    /// Compares the chain's light with the truth of the same frame.
    #[must_use]
    pub fn new(
        truth: &ConvergedTruth,
        asked: &ReportRequest,
        chain: &ChainLight<'_>,
        range: Option<&Plane<f32>>,
    ) -> Self {
        let goal = &asked.goal;
        let missing = if asked.has_sea {
            "waves"
        } else {
            "veil of daylight"
        };
        let estimate = &truth.estimate;
        let compare = |light: &Rgb<f32>, part| Comparison::new(light, estimate, part, range, goal.block);
        let all = Rgb::from_fn(estimate.size.0, estimate.size.1, |x, y| {
            [0, 1, 2].map(|i| chain.direct.planes()[i].pixel(x, y) + chain.scattered.planes()[i].pixel(x, y))
        });
        Self {
            paths: estimate.paths,
            converged: truth.is_converged,
            ended_by: if truth.is_converged { "target" } else { asked.limit },
            phase: asked.law,
            target: goal.target,
            block: goal.block,
            cut: estimate.cut(),
            heavy_tail: truth.is_slow,
            mean: [0, 1, 2].map(|i| estimate.whole(i, LightPart::All)),
            block_error: [0, 1, 2].map(|i| estimate.spread(goal.block, i)),
            chain: PartComparisons {
                unscattered: compare(chain.direct, LightPart::Unscattered),
                scattered: compare(chain.scattered, LightPart::Scattered),
                all: compare(&all, LightPart::All),
            },
            rays: asked.rays,
            left_out: std::iter::once(missing).chain(LEFT_OUT).collect(),
        }
    }
}

impl ConvergedTruth {
    /// Means of the pixels, and their standard errors.
    #[must_use]
    pub fn pictures(&self) -> [Rgb<f32>; 2] {
        let (width, height) = self.estimate.size;
        [
            |level: Level| level.mean as f32,
            |level: Level| level.error as f32,
        ]
        .map(|value| {
            Rgb::from_fn(width, height, |x, y| {
                [0, 1, 2].map(|i| value(self.estimate.pixel(y * width + x, i, LightPart::All)))
            })
        })
    }
}
