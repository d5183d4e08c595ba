//! Accuracy and path budget of the Monte Carlo truth.

use serde::{Deserialize, Serialize};
use spec_derive::Described;

/// Nominal paths per second of one core and channel. It is a convention, so that the bytes of a frame with a time
/// budget depend only on its description.
pub const NOMINAL_PATHS_PER_S: f64 = 500_000.0;
/// Minimum paths of a pixel and channel: one for each batch of the error estimate.
pub const LEAST_PATHS: u64 = 16;
/// Maximum pixels × paths of a channel without a budget: 65536 × 65536.
pub const MOST_WORK: u64 = 1 << 32;

/// Accuracy of the Monte Carlo light of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Truth {
    /// standard error of the median block, as a share of the frame's mean
    #[field(fixed, within(0.001, 0.5), default = 0.02)]
    pub target: f64,
    /// maximum paths of each pixel and channel; pixels times paths beyond 2^32 need `budget_s`
    #[field(fixed, within(16, 1_048_576), default = 65536)]
    pub paths_max: u64,
    /// nominal time on one core at 500 000 paths per second, independent of the clock; limited only by `paths_max` by
    /// default
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

/// Why a frame of this size cannot be traced.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum TooMuch {
    /// The paths exceed the limit without a budget.
    #[error(
        "`truth` can need {paths} paths for each of {pixels} pixels, the limit without `truth.budget_s` is {MOST_WORK} in total"
    )]
    NeedsBudget {
        /// Pixels of the frame.
        pixels: u64,
        /// Maximum paths of each pixel.
        paths: u64,
    },
    /// The budget is too small for the first batch of paths.
    #[error(
        "`truth.budget_s` is {budget_s}, but the first {LEAST_PATHS} paths of {pixels} pixels need {least_s} s"
    )]
    BudgetTooSmall {
        /// The budget, s.
        budget_s: f64,
        /// Pixels of the frame.
        pixels: u64,
        /// Minimum budget, s.
        least_s: f64,
    },
}

impl Truth {
    /// Maximum paths of each pixel and channel for this number of pixels, and whether the budget rather than
    /// `paths_max` limits them.
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
        let one_path_s = seconds(pixels, 1);
        let affordable = (budget_s / one_path_s).floor() as u64;
        if affordable < LEAST_PATHS {
            return Err(TooMuch::BudgetTooSmall {
                budget_s,
                pixels,
                least_s: one_path_s * LEAST_PATHS as f64,
            });
        }
        // The tracer doubles the paths, so only powers of two of the first batch are used.
        let affordable = LEAST_PATHS << (affordable / LEAST_PATHS).ilog2();
        Ok((affordable.min(self.paths_max), affordable < self.paths_max))
    }
}

/// Nominal seconds for this many paths of each pixel and channel.
#[must_use]
pub fn seconds(pixels: u64, paths: u64) -> f64 {
    3.0 * pixels as f64 * paths as f64 / NOMINAL_PATHS_PER_S
}

/// Result of a traced frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TruthRecord {
    /// Paths of each pixel and channel.
    pub paths: u64,
    /// The limit that ended it: `target`, `paths_max` or `budget_s`.
    pub ended_by: String,
    /// Paths truncated by a limit, which lose light.
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
        assert!(refused.unwrap_err().contains("is 4294967296 in total"));
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
        assert!(paid(9.5).unwrap_err().to_string().contains("need 9.6"));
    }
}
