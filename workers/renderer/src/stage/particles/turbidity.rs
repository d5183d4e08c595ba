//! Paths through turbid patches: closed forms of the range, computed before any light is planned.

use optics::plan::{ErrorBound, Stage, StageId};
use optics::range::farthest;
use optics::turbidity;

use crate::assessment::Assessment;

/// Nanoseconds per pixel.
const PATH_NS: f64 = 5.3;

/// Largest optical depth with relative errors. Light from behind more water is faint, so its errors are absolute.
const DEEPEST: f64 = 6.0;

/// An error `e` of an optical depth x changes direct light by `e` times itself, and the veil by `e/x` times itself at most. The
/// error is relative to the longer of path and range.
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
    // In clear patches a path is shorter than its range, so its relative rounding error is larger.
    let [_, least, _] = assessment.context.path_factors.unwrap_or([1.0; 3]);
    let stretch = 1.0 / least.clamp(f64::MIN_POSITIVE, 1.0);
    let deepest = ((c * path_m).min(DEEPEST) * stretch).min(c * range_m.max(path_m));
    let beyond = DEEPEST * (-DEEPEST).exp() * stretch;
    let brightest = assessment.bounds.brightest.into_iter().fold(0.0, f32::max);
    let bound = ErrorBound {
        absolute: share * beyond * f64::from(brightest),
        relative: share * (stretch + deepest),
    };
    Stage {
        bound: Some(bound),
        ..Stage::new(StageId::Turbidity, assessment.variant("closed_form"))
    }
    .costing(PATH_NS, assessment.pixels())
}
