//! Water alone: the bound of the plan, and its cost beside that of the cheapest form that would have done.

use optics::chain;
use optics::forward_scatter::KernelCache;
use optics::plan::{Form, Plan, ScatterStep, SceneBounds};
use spec::Fidelity;

use super::cases::Case;
use super::{Cost, Outcome, codes_of, errors_of};
use crate::chart::time_once;

/// Runs of a frame of which the fastest counts.
const RUNS: usize = 5;

/// Runs one frame: an outcome for each channel, none where the frame cannot be rendered.
pub(super) fn run(case: &Case) -> Vec<Outcome> {
    let Case {
        radiance,
        range,
        water,
        ..
    } = case;
    let stats = SceneBounds::measure(radiance, range, water);
    let planned_for = |fidelity| Plan::for_water(&stats, water, fidelity);
    let plan = planned_for(Fidelity::Tolerance(case.tolerance));
    let doubled = (radiance.map(|&j| f64::from(j)), range.map(|&z| f64::from(z)));
    let Ok(exact) = chain::water_reference(&doubled.0, &doubled.1, water) else {
        return Vec::new();
    };
    let mut cache = KernelCache::new();
    let mut render = |plan: &Plan| chain::water(radiance, range, water, plan, &mut cache).ok();
    let mut errors = |plan: &Plan| {
        render(plan).map_or([f64::INFINITY; 3], |layers| {
            errors_of(&layers.scattered, &exact.scattered)
        })
    };
    let planned = errors(&plan);
    let cheapest = cheapest(case, &plan, &planned_for, &mut errors);
    let shown = render(&planned_for(Fidelity::DISPLAY));
    let display_codes = shown.map(|layers| codes_of(&layers.scattered, &exact.scattered));
    let (mut planned_ms, mut cheapest_ms) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..RUNS {
        for (plan, ms) in [(&plan, &mut planned_ms), (&cheapest, &mut cheapest_ms)] {
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
        display_codes: display_codes.map_or(Some(u8::MAX), |codes| Some(codes[channel])),
        exceeds: plan.exceeds.is_some(),
        cost: Some(Cost {
            terms: terms(&plan, channel),
            fewest: terms(&cheapest, channel),
            planned_ms,
            cheapest_ms,
        }),
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
