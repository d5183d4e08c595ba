//! Random frames against the promise of the plan: that no error exceeds its bound, and that water costs little more than in the
//! cheapest form that would have done.

mod adversary;
mod cases;
mod mixture;
mod random_water;
mod report;
mod scene;
mod water;
mod whole;

use imaging::{Rgb, transfer};

pub use report::{Summary, bound_chart, cost_chart, markdown};
pub use whole::Studio;

/// What one channel of one frame showed.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Which frame.
    pub seed: u64,
    /// Which channel.
    pub channel: usize,
    /// `jaffe`, `simplified` or `mixture`, and what else describes the frame.
    pub about: String,
    /// What was asked for.
    pub tolerance: f64,
    /// What the plan promised.
    pub bound: f64,
    /// What came out, against f64.
    pub error: f64,
    /// Largest difference of 8-bit codes where the plan was made for `display`; none where it says that it cannot keep to that.
    pub display_codes: Option<u8>,
    /// Whether the plan says why its bound is above the tolerance.
    pub exceeds: bool,
    /// What the channel costs; only of water alone, since nobody knows the cheapest sufficient form of anything else.
    pub cost: Option<Cost>,
}

/// What one channel of water costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Kernels of the plan; 0 where nothing is transformed.
    pub terms: usize,
    /// The fewest kernels that stay within the tolerance.
    pub fewest: usize,
    /// Fastest run of the whole frame as planned.
    pub planned_ms: f64,
    /// Fastest run of the whole frame in the cheapest sufficient form.
    pub cheapest_ms: f64,
}

impl Cost {
    /// Cost of the plan in units of the cheapest sufficient form. A channel costs a transform for each kernel, one more
    /// to come back, and about half as much as one for everything else: the chart of cost against kernels shows it.
    #[must_use]
    pub fn excess(&self) -> f64 {
        let cost = |terms: usize| if terms == 0 { 0.5 } else { terms as f64 + 1.5 };
        cost(self.terms) / cost(self.fewest)
    }

    /// The same of the whole frame by the clock.
    #[must_use]
    pub fn excess_ms(&self) -> f64 {
        self.planned_ms / self.cheapest_ms
    }
}

impl Outcome {
    /// The error is above the bound, or no number.
    #[must_use]
    pub fn is_broken(&self) -> bool {
        self.error.is_nan() || self.error > self.bound
    }

    /// The bound is above the tolerance, and the plan does not say why.
    #[must_use]
    pub fn is_silent(&self) -> bool {
        !self.exceeds && self.bound > self.tolerance * (1.0 + 1e-9)
    }

    /// Whether the frame holds lamps, patches of turbidity or snow.
    #[must_use]
    pub fn is_mixture(&self) -> bool {
        self.cost.is_none()
    }
}

/// One of this many frames holds lamps, patches or snow.
const MIXTURES: u64 = 4;

/// Runs the frame of a seed: an outcome for each channel, none where the frame cannot be rendered.
#[must_use]
pub fn run(seed: u64, studio: &mut Studio) -> Vec<Outcome> {
    if seed % MIXTURES == 1 {
        studio.run(seed)
    } else {
        water::run(&cases::case(seed))
    }
}

/// The largest difference of the 8-bit codes of each channel.
fn codes_of(fast: &Rgb<f32>, exact: &Rgb<f64>) -> [u8; 3] {
    let ours = transfer::encode_rgb8(fast).0;
    let exact = transfer::encode_rgb8(&exact.map(|&v| v as f32)).0;
    let mut most = [0; 3];
    for (ours, exact) in ours.pixels().zip(exact.pixels()) {
        for channel in 0..3 {
            most[channel] = ours[channel].abs_diff(exact[channel]).max(most[channel]);
        }
    }
    most
}

/// The largest error of each channel.
fn errors_of(fast: &Rgb<f32>, exact: &Rgb<f64>) -> [f64; 3] {
    [0, 1, 2].map(|channel| {
        let fast = fast.planes()[channel].data().iter();
        let errors = fast
            .zip(exact.planes()[channel].data())
            .map(|(&fast, exact)| (f64::from(fast) - exact).abs());
        // NaN counts as infinite.
        errors.fold(0.0, |worst, error| {
            if error <= worst {
                worst
            } else if error.is_nan() {
                f64::INFINITY
            } else {
                error
            }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A part of the campaign whose figures are in the docs. The seeds go on where those end.
    const FRAMES: std::ops::Range<u64> = 1_000_000..1_000_300;

    fn outcomes(seeds: std::ops::Range<u64>) -> Vec<Outcome> {
        let mut studio = Studio::new();
        seeds.flat_map(|seed| run(seed, &mut studio)).collect()
    }

    #[test]
    fn no_error_exceeds_its_bound_and_the_plan_is_near_the_cheapest() {
        let outcomes = outcomes(FRAMES);
        assert!(
            outcomes.len() >= 3 * 290,
            "frames cannot be rendered: {}",
            outcomes.len()
        );
        let broken: Vec<&Outcome> = outcomes
            .iter()
            .filter(|o| o.is_broken() || o.is_silent())
            .collect();
        assert!(broken.is_empty(), "{broken:#?}");
        let summary = Summary::new(&outcomes);
        assert!(
            summary.excess_median <= 1.5 && summary.excess_95 <= 2.0 && summary.display_codes <= 1,
            "{summary:#?}"
        );
    }

    #[test]
    fn a_bound_that_is_too_small_is_found() {
        let mut outcomes = outcomes(0..20);
        assert_eq!(Summary::new(&outcomes).broken, 0);
        outcomes[7].bound = outcomes[7].error * 0.99 - 1e-12;
        assert_eq!(Summary::new(&outcomes).broken, 1);
    }
}
