//! What is asked of the Monte Carlo truth of a frame, and how many paths that may take.

use serde::{Deserialize, Serialize};
use spec_derive::Described;

/// Paths of one channel that a core of a server processor is taken to follow in a second. A convention and no measurement of the
/// machine at hand, so that the bytes of a frame with a time budget follow from its description alone.
pub const NOMINAL_PATHS_PER_S: f64 = 500_000.0;
/// Fewest paths of a pixel and channel: one of each batch, from whose scatter the error follows.
pub const LEAST_PATHS: u64 = 16;
/// Pixels times paths of each channel that need no budget: 65536 of 65536.
pub const MOST_WORK: u64 = 1 << 32;

/// How well the light of a frame must be known by Monte Carlo.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Truth {
    /// error of the median block as a share of the frame's mean
    #[field(fixed, within(0.001, 0.5), default = 0.02)]
    pub target: f64,
    /// most paths of each pixel and channel; pixels times paths beyond 2^32 need `budget_s`
    #[field(fixed, within(16, 1_048_576), default = 65536)]
    pub paths_max: u64,
    /// as many paths as one core follows in this time at 500 000 in a second, by convention and not by the clock; without it
    /// `paths_max` is the only limit
    #[field(fixed, above(0.0, 1e6), unit = "s")]
    pub budget_s: Option<f64>,
}

impl Default for Truth {
    fn default() -> Self {
        Self {
            target: 0.02,
            paths_max: 65_536,
            budget_s: None,
        }
    }
}

/// Why a frame of so many pixels cannot be traced.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum TooMuch {
    /// More paths than are followed without a budget.
    #[error(
        "`truth` may take {paths} paths of each of {pixels} pixels, the limit is {MOST_WORK} in all without `truth.budget_s`"
    )]
    NeedsBudget {
        /// Pixels of the frame.
        pixels: u64,
        /// Most paths of each.
        paths: u64,
    },
    /// The budget does not even pay for the first paths.
    #[error(
        "`truth.budget_s` is {budget_s}, but the first {LEAST_PATHS} paths of {pixels} pixels take {least_s}"
    )]
    BudgetTooSmall {
        /// The budget, s.
        budget_s: f64,
        /// Pixels of the frame.
        pixels: u64,
        /// What is needed, s.
        least_s: f64,
    },
}

impl Truth {
    /// The most paths of each pixel and channel in a frame of so many pixels, and whether the budget rather than `paths_max` says
    /// so.
    ///
    /// # Errors
    /// [`TooMuch`].
    pub fn most_paths(&self, pixels: u64) -> Result<(u64, bool), TooMuch> {
        let Some(budget_s) = self.budget_s else {
            return if pixels.saturating_mul(self.paths_max) > MOST_WORK {
                Err(TooMuch::NeedsBudget {
                    pixels,
                    paths: self.paths_max,
                })
            } else {
                Ok((self.paths_max, false))
            };
        };
        let each = seconds(pixels, 1);
        let paid = (budget_s / each).floor() as u64;
        if paid < LEAST_PATHS {
            return Err(TooMuch::BudgetTooSmall {
                budget_s,
                pixels,
                least_s: each * LEAST_PATHS as f64,
            });
        }
        // Paths are doubled from the first on: what lies between is not paid for.
        let paid = LEAST_PATHS << (paid / LEAST_PATHS).ilog2();
        Ok((paid.min(self.paths_max), paid < self.paths_max))
    }
}

/// Seconds that so many paths of each pixel and channel take by convention.
#[must_use]
pub fn seconds(pixels: u64, paths: u64) -> f64 {
    3.0 * pixels as f64 * paths as f64 / NOMINAL_PATHS_PER_S
}

/// What was traced of a frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TruthRecord {
    /// Paths of each pixel and channel.
    pub paths: u64,
    /// What ended it: `target`, `paths_max` or `budget_s`.
    pub ended_by: String,
    /// Paths that a limit cut; their light is too little.
    pub cut: u64,
    /// Standard error of the median block, red, green, blue.
    pub median_error: [f64; 3],
    /// Standard error that 95 % of the blocks stay below.
    pub error_95: [f64; 3],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_pays_for_paths_by_convention_and_lifts_the_limit() {
        let truth = Truth::default();
        assert_eq!(truth.most_paths(65_536), Ok((65_536, false)));
        let refused = truth.most_paths(65_537).map_err(|wrong| wrong.to_string());
        assert!(refused.unwrap_err().contains("the limit is 4294967296"));
        let paid = |budget_s| {
            Truth {
                budget_s: Some(budget_s),
                ..truth
            }
            .most_paths(100_000)
        };
        // 16 paths of 100 000 pixels and three channels are 4.8 million: 9.6 s.
        assert_eq!(paid(9.7), Ok((16, true)));
        assert_eq!(paid(19.1), Ok((16, true)));
        assert_eq!(paid(19.3), Ok((32, true)));
        assert_eq!(paid(1e6), Ok((65_536, false)));
        assert!(paid(9.5).unwrap_err().to_string().contains("take 9.6"));
    }
}
