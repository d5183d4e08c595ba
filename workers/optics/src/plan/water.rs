//! Attenuation and forward scatter: what of them a tolerance needs.

use spec::Fidelity;

use super::{Form, ScatterStep, SceneStats, Stage, levels, scatter};
use crate::water::Water;

/// Attenuation is left out where that loses no more than this part of the tolerance.
const SKIP_SHARE: f64 = 0.125;
/// What is left for the scatter where f32 alone uses up the tolerance.
const LEAST_SHARE: f64 = 0.125;

/// Attenuation and forward scatter.
pub(super) struct WaterStages {
    pub(super) attenuation: Stage,
    pub(super) scatter: [Stage<ScatterStep>; 3],
    /// What f32 may lose in any channel.
    pub(super) rounding: f64,
}

impl WaterStages {
    pub(super) fn none() -> Self {
        Self {
            attenuation: Stage::exact(Form::Skip),
            scatter: [const { ScatterStep::Skip }; 3].map(Stage::exact),
            rounding: 0.0,
        }
    }

    pub(super) fn choose(stats: &SceneStats, water: &Water, fidelity: Fidelity) -> Self {
        let tolerance = levels::tolerance(stats, water, fidelity);
        let lost = [0, 1, 2].map(|channel| levels::attenuation_effect(stats, water, channel));
        let is_clear = tolerance.is_some_and(|whole| lost.iter().all(|&lost| lost <= SKIP_SHARE * whole));
        let rounding = [0, 1, 2].map(|channel| levels::rounding(stats, water, channel));
        let used = |channel: usize| rounding[channel] + if is_clear { lost[channel] } else { 0.0 };
        let scatter = [0, 1, 2].map(|channel| {
            let share = tolerance.map(|whole| (whole - used(channel)).max(LEAST_SHARE * whole));
            let (form, bound) = scatter::choose(stats, water, channel, fidelity, share.unwrap_or(0.0));
            Stage {
                form,
                share: tolerance,
                bound: tolerance.map(|_| used(channel) + bound.unwrap_or(0.0)),
            }
        });
        let form = Form::asked_by(fidelity);
        Self {
            attenuation: Stage::exact(form.when(form == Form::Reference || !is_clear)),
            scatter,
            rounding: rounding.into_iter().fold(0.0, f64::max),
        }
    }
}
