//! Random frames against the promise of the plan: that no error exceeds its bound, and that it costs little more than the
//! cheapest form that would have done.

mod adversary;
mod cases;
mod report;

use imaging::{Rgb, transfer};
use optics::chain::{self, Layers};
use optics::forward_scatter::KernelCache;
use optics::plan::{Form, Plan, ScatterStep, SceneStats};
use spec::Fidelity;

use crate::chart::time_once;

pub use cases::{Case, case};
pub use report::{Summary, bound_chart, cost_chart, markdown};

/// What one channel of one frame showed.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Which frame.
    pub seed: u64,
    /// Which channel.
    pub channel: usize,
    /// `jaffe` or `simplified`, and what else describes the frame.
    pub about: String,
    /// What was asked for.
    pub tolerance: f64,
    /// What the plan promised.
    pub bound: f64,
    /// What came out, against f64.
    pub error: f64,
    /// Kernels of the plan; 0 where nothing is transformed.
    pub terms: usize,
    /// The fewest kernels that stay within the tolerance.
    pub fewest: usize,
    /// Largest difference of 8-bit codes where the plan was made for `display`.
    pub display_codes: u8,
    /// Fastest run of the frame as planned, and in the cheapest sufficient form; the same for its channels.
    pub ms: (f64, f64),
}

impl Outcome {
    /// The error is above the bound, or no number.
    #[must_use]
    pub fn is_broken(&self) -> bool {
        self.error.is_nan() || self.error > self.bound
    }

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
        self.ms.0 / self.ms.1
    }
}

/// Runs of a frame of which the fastest counts.
const RUNS: usize = 5;

/// Runs one frame: an outcome for each channel, none where the frame cannot be rendered.
#[must_use]
pub fn run(case: &Case) -> Vec<Outcome> {
    let Case {
        radiance,
        range,
        water,
        ..
    } = case;
    let stats = SceneStats::measure(radiance, range, water);
    let planned_for = |fidelity| Plan::for_water(&stats, water, fidelity);
    let plan = planned_for(Fidelity::Tolerance(case.tolerance));
    let doubled = (radiance.map(|&j| f64::from(j)), range.map(|&z| f64::from(z)));
    let Ok(exact) = chain::water_reference(&doubled.0, &doubled.1, water) else {
        return Vec::new();
    };
    let mut cache = KernelCache::new();
    let mut render = |plan: &Plan| chain::water(radiance, range, water, plan, &mut cache).ok();
    let mut errors =
        |plan: &Plan| render(plan).map_or([f64::INFINITY; 3], |layers| errors_of(&layers, &exact));
    let planned = errors(&plan);
    let cheapest = cheapest(case, &plan, &planned_for, &mut errors);
    let shown = render(&planned_for(Fidelity::DISPLAY));
    let display_codes = shown.map_or([u8::MAX; 3], |layers| codes_of(&layers, &exact));
    let mut ms = (f64::INFINITY, f64::INFINITY);
    for _ in 0..RUNS {
        for (plan, ms) in [(&plan, &mut ms.0), (&cheapest, &mut ms.1)] {
            *ms = ms.min(time_once(|| render(plan)));
        }
    }
    let terms = |plan: &Plan, channel: usize| kernels(&plan.scatter[channel].form);
    let outcome = |channel: usize| Outcome {
        seed: case.seed,
        channel,
        about: case.about.clone(),
        tolerance: case.tolerance,
        bound: plan.bounds().map_or(f64::NAN, |bounds| bounds[channel]),
        error: planned[channel],
        terms: terms(&plan, channel),
        fewest: terms(&cheapest, channel),
        display_codes: display_codes[channel],
        ms,
    };
    [0, 1, 2].map(outcome).into()
}

/// Of each channel the form of the fewest kernels whose error stays within the tolerance; that of the plan where no cheaper
/// one does.
fn cheapest(
    case: &Case,
    plan: &Plan,
    planned_for: &impl Fn(Fidelity) -> Plan,
    errors: &mut impl FnMut(&Plan) -> [f64; 3],
) -> Plan {
    let most = plan
        .scatter
        .iter()
        .map(|stage| kernels(&stage.form))
        .max()
        .unwrap_or(0);
    let mut forms: Vec<[ScatterStep; 3]> = pointless(plan);
    let steps = |plan: Plan| plan.scatter.map(|stage| stage.form);
    forms.extend((1..most).map(|terms| steps(planned_for(Fidelity::Terms(terms)))));
    let mut cheapest = plan.clone();
    let mut found = [false; 3];
    for form in forms {
        let mut cheaper = plan.clone();
        cheaper.attenuation.form = Form::Fast;
        for (stage, form) in cheaper.scatter.iter_mut().zip(form) {
            stage.form = form;
        }
        let errors = errors(&cheaper);
        for channel in 0..3 {
            let step = &cheaper.scatter[channel].form;
            let saves = kernels(step) < kernels(&cheapest.scatter[channel].form);
            if !found[channel] && saves && errors[channel] <= case.tolerance {
                found[channel] = true;
                cheapest.scatter[channel].form = step.clone();
            }
        }
    }
    cheapest
}

fn kernels(step: &ScatterStep) -> usize {
    step.terms().unwrap_or(0)
}

/// The forms without any transform.
fn pointless(plan: &Plan) -> Vec<[ScatterStep; 3]> {
    let interpolates = plan.scatter.iter().any(|stage| stage.form.terms().is_some());
    let forms = [ScatterStep::Skip, ScatterStep::Pointwise];
    forms
        .into_iter()
        .filter(|_| interpolates)
        .map(|form| [form.clone(), form.clone(), form])
        .collect()
}

/// The largest difference of the 8-bit codes of each channel of the image.
fn codes_of(fast: &Layers, exact: &Layers<f64>) -> [u8; 3] {
    let ours = transfer::encode_rgb8(&fast.scattered).0;
    let exact = transfer::encode_rgb8(&exact.scattered.map(|&v| v as f32)).0;
    let mut most = [0; 3];
    for (ours, exact) in ours.pixels().zip(exact.pixels()) {
        for channel in 0..3 {
            most[channel] = ours[channel].abs_diff(exact[channel]).max(most[channel]);
        }
    }
    most
}

/// The largest error of each channel of the image.
fn errors_of(fast: &Layers, exact: &Layers<f64>) -> [f64; 3] {
    let (fast, exact): (&Rgb<f32>, &Rgb<f64>) = (&fast.scattered, &exact.scattered);
    [0, 1, 2].map(|c| {
        let pairs = fast.planes()[c].data().iter().zip(exact.planes()[c].data());
        let errors = pairs.map(|(f, e)| (f64::from(*f) - e).abs());
        // NaN counts as infinite.
        errors.fold(0.0, |worst, e| {
            if e <= worst {
                worst
            } else if e.is_nan() {
                f64::INFINITY
            } else {
                e
            }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A part of the campaign whose figures are in the docs. The seeds go on where those end.
    const FRAMES: std::ops::Range<u64> = 1_000_000..1_000_300;

    #[test]
    fn no_error_exceeds_its_bound_and_the_plan_is_near_the_cheapest() {
        let outcomes: Vec<Outcome> = FRAMES.map(case).flat_map(|case| run(&case)).collect();
        assert!(
            outcomes.len() >= 3 * 290,
            "frames cannot be rendered: {}",
            outcomes.len()
        );
        let broken: Vec<&Outcome> = outcomes.iter().filter(|o| o.is_broken()).collect();
        assert!(broken.is_empty(), "{broken:#?}");
        let summary = Summary::of(&outcomes);
        assert!(
            summary.excess_median <= 1.5 && summary.excess_95 <= 2.0 && summary.display_codes <= 1,
            "{summary:#?}"
        );
    }

    #[test]
    fn a_bound_that_is_too_small_is_found() {
        let mut outcomes: Vec<Outcome> = (0..20).map(case).flat_map(|case| run(&case)).collect();
        assert_eq!(Summary::of(&outcomes).broken, 0);
        outcomes[7].bound = outcomes[7].error * 0.99 - 1e-12;
        assert_eq!(Summary::of(&outcomes).broken, 1);
    }
}
