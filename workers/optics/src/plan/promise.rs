//! The promise of a plan: one number and one sentence for every place that prints or stores them.

use spec::Promise;

use super::{ErrorBound, MOST_TERMS, Plan, StageId, Variant};

/// White of the exposed light. A picture is clipped at black and white, which limits the error of a sample.
const WHITE: f64 = 1.0;
/// A bound may exceed a tolerance by the rounding of the sum of its parts.
const SUM_ROUNDING: f64 = 1e-9;

impl Plan {
    /// The promise; `None` without a tolerance.
    ///
    /// It refers to the exposed light cut at black and white, in the fast chain as in the exact one. Its bound is therefore at most
    /// [`WHITE`] for any sum of the stages; [`Plan::errors`] composes their bounds without this limit. Relative errors count as in
    /// white, unless the tolerance has a relative part.
    #[must_use]
    pub fn promise(&self) -> Option<Promise> {
        let tolerance = self.tolerance?;
        let error = self.promised_error()?;
        let ErrorBound {
            absolute: bound,
            relative,
        } = error;
        let unbounded: Vec<_> = self.unbounded().map(|id| id.name().to_owned()).collect();
        let apart = if unbounded.is_empty() {
            String::new()
        } else {
            format!(", apart from {}, whose errors have no bound", join(&unbounded))
        };
        let exceeds = self.find_excess(error, tolerance);
        let share = if relative > 0.0 {
            format!(" plus {:.2} % of its value", 100.0 * relative)
        } else {
            String::new()
        };
        let text = format!(
            "Every sample of the exposed light, from black to white, differs from the exact chain by at most {bound:.2e}{share}{apart}."
        );
        Some(Promise {
            bound,
            relative,
            tolerance: tolerance.absolute,
            relative_tolerance: tolerance.relative,
            unbounded,
            exceeds,
            text,
        })
    }

    /// The error that the plan promises, in the terms of its tolerance; `None` without a tolerance.
    #[must_use]
    pub fn promised_error(&self) -> Option<ErrorBound> {
        let error = self.error();
        let error = if self.tolerance?.relative > 0.0 {
            error
        } else {
            ErrorBound::absolute(error.up_to_white())
        };
        Some(error.lesser(ErrorBound {
            absolute: WHITE,
            relative: WHITE,
        }))
    }

    /// Stages before the picture that run without a bound.
    pub fn unbounded(&self) -> impl Iterator<Item = StageId> {
        let promised = self.stages.iter().filter(|stage| stage.id.is_promised());
        promised
            .filter(|stage| stage.is_unbounded())
            .map(|stage| stage.id)
    }

    /// Why the bound exceeds the tolerance, and what to change.
    fn find_excess(&self, error: ErrorBound, tolerance: ErrorBound) -> Option<String> {
        if error.is_within(tolerance.scaled(1.0 + SUM_ROUNDING)) {
            return None;
        }
        let exceeds_in_black = tolerance.relative > 0.0 && error.absolute > tolerance.absolute;
        let light = if exceeds_in_black { 0.0 } else { WHITE };
        let [bound, tolerance] = [error, tolerance].map(|error| error.bound_sample(light));
        let worst = self.find_largest(light);
        let culprit = worst.map_or(String::new(), |(id, error)| {
            format!(", most of it ({:.2e}) from {}", error.min(WHITE), id.name())
        });
        let remedy = match worst.map(|(id, _)| id) {
            Some(StageId::Lamps | StageId::LampShadows | StageId::Glow) => {
                Some("lower the intensity of the lamps or move them away from surfaces")
            }
            Some(StageId::Exposure) => Some("lower `camera.exposure`"),
            Some(StageId::Defocus) => Some("lower `camera.defocus.aperture_m`"),
            Some(StageId::ForwardScatter(_)) if self.needs_most_kernels() => {
                Some("choose a water that scatters less")
            }
            _ => None,
        };
        let enough = round_up(bound);
        // A tolerance of white admits any picture.
        let raise = (enough < WHITE).then(|| format!("raise `fidelity.tolerance` to {enough:e}"));
        let remedies = match (raise, remedy) {
            (Some(raise), Some(remedy)) => format!("{raise} or {remedy}"),
            (Some(raise), None) => raise,
            (None, Some(remedy)) => format!("no tolerance below white is large enough: {remedy}"),
            (None, None) => "no tolerance below white is large enough".to_owned(),
        };
        Some(format!(
            "the bounds add up to {bound:.2e} and the tolerance is {tolerance:.2e}{culprit}; {remedies}"
        ))
    }

    /// The stage that adds most to the error of this much exposed light, and that error.
    fn find_largest(&self, light: f64) -> Option<(StageId, f64)> {
        let promised: Vec<_> = self
            .stages
            .iter()
            .filter(|stage| stage.id.is_promised())
            .collect();
        let share = |at: usize| {
            let gain = super::shares::compose_gain(promised[at + 1..].iter().copied().filter(|stage| {
                let own = promised[at].id.channel();
                stage
                    .id
                    .channel()
                    .is_none_or(|channel| own.is_none_or(|own| own == channel))
            }));
            promised[at]
                .bound
                .unwrap_or_default()
                .behind(gain)
                .bound_sample(light)
        };
        let shares = (0..promised.len()).map(|at| (promised[at].id, share(at)));
        shares.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    fn needs_most_kernels(&self) -> bool {
        let scatter = (0..3).map(|channel| self.variant(StageId::ForwardScatter(channel)));
        scatter
            .filter_map(Variant::kernels)
            .any(|terms| terms >= MOST_TERMS)
    }
}

/// The next number of one digit.
fn round_up(value: f64) -> f64 {
    let scale = 10f64.powf(value.log10().floor());
    let digit = (value / scale).ceil();
    format!("{digit}e{}", scale.log10().round())
        .parse()
        .unwrap_or(value)
}

fn join(names: &[String]) -> String {
    match names {
        [] => String::new(),
        [only] => only.clone(),
        [rest @ .., last] => format!("{} and {last}", rest.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Gain, Stage};
    use super::*;

    fn plan(bound: f64, gain: f64) -> Plan {
        let lamps = Stage {
            bound: Some(ErrorBound::absolute(bound)),
            ..Stage::new(StageId::Lamps, Variant::Fast("f32"))
        };
        let exposure = Stage {
            bound: Some(ErrorBound::relative(1e-7)),
            gain: Gain::factor(gain),
            ..Stage::new(StageId::Exposure, Variant::Fast("fixed"))
        };
        let style = Stage {
            bound: Some(ErrorBound::absolute(1.0)),
            ..Stage::new(StageId::Style, Variant::Fast("table"))
        };
        Plan {
            tolerance: Some(ErrorBound::absolute(3e-4)),
            stages: vec![lamps, exposure, style],
        }
    }

    #[test]
    fn an_exposure_amplifies_errors_and_a_style_is_not_counted() {
        let promise = plan(1e-5, 20.0).promise().unwrap();
        assert!((promise.bound - (2e-4 + 1e-7)).abs() < 1e-12, "{promise:?}");
        assert_eq!(promise.exceeds, None);
        assert!(
            promise.text.ends_with("from the exact chain by at most 2.00e-4."),
            "{}",
            promise.text
        );
    }

    #[test]
    fn a_bound_above_the_tolerance_names_the_stage_and_the_remedy() {
        let exceeds = plan(1e-4, 20.0).promise().unwrap().exceeds.unwrap();
        assert!(
            exceeds.contains("2.00e-3") && exceeds.contains("from lamps"),
            "{exceeds}"
        );
        assert!(
            exceeds.contains("raise `fidelity.tolerance` to 3e-3"),
            "{exceeds}"
        );
        assert!(exceeds.contains("lower the intensity"), "{exceeds}");
    }

    #[test]
    fn a_tolerance_with_a_share_of_the_light_is_promised_in_two_parts() {
        let mut plan = plan(1e-5, 20.0);
        plan.tolerance = Some(ErrorBound {
            absolute: 2.9e-4,
            relative: 4e-3,
        });
        plan.stages[0].bound = Some(ErrorBound {
            absolute: 1e-5,
            relative: 2e-3,
        });
        let promise = plan.promise().unwrap();
        assert_eq!(promise.exceeds, None, "{promise:?}");
        assert!((promise.relative - 2.0001e-3).abs() < 1e-9, "{promise:?}");
        assert!(
            promise
                .text
                .ends_with("by at most 2.00e-4 plus 0.20 % of its value."),
            "{}",
            promise.text
        );
        plan.stages[0].bound = Some(ErrorBound::absolute(2e-5));
        let exceeds = plan.promise().unwrap().exceeds.unwrap();
        assert!(
            exceeds.contains("4.00e-4 and the tolerance is 2.90e-4"),
            "{exceeds}"
        );
        plan.stages[0].bound = Some(ErrorBound::relative(5e-3));
        let exceeds = plan.promise().unwrap().exceeds.unwrap();
        assert!(
            exceeds.contains("5.00e-3 and the tolerance is 4.29e-3"),
            "{exceeds}"
        );
    }

    #[test]
    fn no_promise_is_above_white() {
        let promise = plan(1e7, 20.0).promise().unwrap();
        assert_eq!(promise.bound, 1.0);
        assert!(promise.text.contains("at most 1.00e0"), "{}", promise.text);
        let exceeds = promise.exceeds.unwrap();
        assert!(
            exceeds.contains("add up to 1.00e0") && exceeds.contains("(1.00e0) from lamps"),
            "{exceeds}"
        );
        assert!(
            exceeds.contains("no tolerance below white is large enough: lower"),
            "{exceeds}"
        );
        assert!(!exceeds.contains("raise"), "{exceeds}");
    }

    #[test]
    fn stages_without_a_bound_are_named() {
        let mut plan = plan(1e-5, 1.0);
        plan.stages[0].bound = None;
        let promise = plan.promise().unwrap();
        assert_eq!(promise.unbounded, ["lamps"]);
        assert!(promise.text.contains("apart from lamps,"), "{}", promise.text);
    }

    #[test]
    fn a_limit_is_rounded_up_to_one_digit() {
        assert_eq!(round_up(2.0001e-3), 3e-3);
        assert_eq!(round_up(9.5e-4), 1e-3);
        assert_eq!(round_up(0.3), 0.3);
    }
}
