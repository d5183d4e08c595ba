//! Attenuation and forward scatter: what of them a tolerance needs.

use spec::Fidelity;

use super::gates::{self, GateStep};
use super::{Form, ScatterStep, SceneStats, Stage, levels, scatter, veil};
use crate::water::Water;

/// Attenuation is left out where that loses no more than this part of the tolerance.
const SKIP_SHARE: f64 = 0.125;
/// What is left for the scatter where f32 alone uses up the tolerance.
const LEAST_SHARE: f64 = 0.125;

/// Attenuation and forward scatter.
pub(super) struct WaterStages {
    pub(super) attenuation: Stage,
    pub(super) veil: Option<Stage>,
    pub(super) gates: Option<Stage<GateStep>>,
    pub(super) scatter: [Stage<ScatterStep>; 3],
    /// What f32 may lose in any channel.
    pub(super) rounding: f64,
}

impl WaterStages {
    pub(super) fn none() -> Self {
        Self {
            attenuation: Stage::exact(Form::Skip),
            veil: None,
            gates: None,
            scatter: [const { ScatterStep::Skip }; 3].map(Stage::exact),
            rounding: 0.0,
        }
    }

    pub(super) fn choose(stats: &SceneStats, water: &Water, fidelity: Fidelity) -> Self {
        let tolerance = levels::tolerance(stats, water, fidelity);
        let lost = [0, 1, 2].map(|channel| levels::attenuation_effect(stats, water, channel));
        let is_clear = tolerance.is_some_and(|whole| lost.iter().all(|&lost| lost <= SKIP_SHARE * whole));
        let rounding = [0, 1, 2].map(|channel| levels::rounding(stats, water, channel));
        let veil = veil::choose(stats, water, fidelity, tolerance);
        let uneven = veil.as_ref().and_then(|veil| veil.bound).unwrap_or(0.0);
        let mut gates = gates::choose(stats, water, fidelity, tolerance);
        let unstopped = gates.as_ref().and_then(|gates| gates.bound).unwrap_or(0.0);
        let used = |channel: usize| {
            rounding[channel] + unstopped + uneven + if is_clear { lost[channel] } else { 0.0 }
        };
        let layering = gates.as_ref().and_then(|gates| gates.form.layering());
        let scatter = [0, 1, 2].map(|channel| {
            let share = tolerance.map(|whole| (whole - used(channel)).max(LEAST_SHARE * whole));
            let asked = scatter::Asked {
                stats,
                water,
                channel,
                layering,
            };
            let (form, bound) = scatter::choose(&asked, fidelity, share.unwrap_or(0.0));
            Stage {
                form,
                share: tolerance,
                bound: tolerance.map(|_| used(channel) + bound.unwrap_or(0.0)),
            }
        });
        if let Some(gates) = &mut gates
            && scatter.iter().all(|stage| stage.form.terms().is_none())
            && gates.form.layering().is_some()
        {
            // No light leaves its pixel, and none has to be stopped.
            gates.form = GateStep::Skip;
        }
        let form = Form::asked_by(fidelity);
        Self {
            veil,
            gates,
            attenuation: Stage::exact(form.when(form == Form::Reference || !is_clear)),
            scatter,
            rounding: rounding.into_iter().fold(0.0, f64::max),
        }
    }
}
