//! Paths through patches of murkier water. They are geometry: closed forms of the range, known before any light is planned.

use imaging::Plane;
use optics::plan::{ErrorBound, Stage, StageId};
use optics::range::farthest;
use optics::setting::Setting;
use optics::turbidity;
use spec::{Fidelity, Frame};

use crate::planning::Assessment;

/// Nanoseconds per pixel.
const PATH_NS: f64 = 5.3;

/// Optical depths up to which errors are counted as a share of the light; of light behind more, which is faint, they are absolute.
const DEEPEST: f64 = 6.0;
/// The clearest patch that is counted, as a share of the mean.
const CLEAREST: f64 = 0.01;

/// An error `e` of an optical depth x changes direct light by `e` times itself, and the veil by `e/x` times itself at most. The
/// error is a share of the path or of the range, whichever is longer.
pub(crate) fn assess(assessment: &Assessment<'_>) -> Stage {
    let setting = &assessment.context.setting;
    let (Some(patches), Some(water)) = (&setting.patches, &setting.around) else {
        return Stage::skipped(StageId::Turbidity);
    };
    let range_m = assessment
        .context
        .prepared
        .scene
        .range
        .as_ref()
        .and_then(farthest)
        .unwrap_or(0.0);
    let path_m = assessment.bounds.range_m.map_or(0.0, |(_, farthest)| farthest);
    let share = turbidity::path_rounding(range_m.max(path_m), patches.scale_m());
    let c = water.direct_attenuation().into_iter().fold(0.0, f64::max);
    let clearest = patches.extremes().0.max(CLEAREST);
    let deepest = ((c * path_m).min(DEEPEST) / clearest).min(c * range_m.max(path_m));
    let is_clearer = patches.extremes().0 < CLEAREST;
    let beyond = if is_clearer {
        c * range_m
    } else {
        DEEPEST * (-DEEPEST).exp() / clearest
    };
    let brightest = assessment.bounds.brightest.into_iter().fold(0.0, f32::max);
    let bound = ErrorBound {
        absolute: share * beyond * f64::from(brightest),
        relative: share * (1.0 / clearest + deepest),
    };
    Stage {
        bound: Some(bound),
        ..Stage::new(StageId::Turbidity, assessment.variant("closed_form"))
    }
    .costing(PATH_NS, assessment.pixels())
}

/// The paths; `None` in even water.
pub(crate) fn run(frame: &Frame, range: &Plane<f32>, setting: &Setting) -> Option<Plane<f32>> {
    let (water, field, eye) = (setting.water.as_ref()?, setting.patches.as_ref()?, &setting.eye);
    Some(match (frame.fidelity, &frame.water.turbidity) {
        (Fidelity::REFERENCE, Some(patches)) => {
            let range = range.map(|&z| f64::from(z));
            turbidity::optical_path_reference(&range, patches, field, eye, water.holes()).map(|&t| t as f32)
        }
        _ => turbidity::optical_path(range, field, eye, water.holes()),
    })
}
