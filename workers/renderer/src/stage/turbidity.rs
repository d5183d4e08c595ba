//! Paths through patches of murkier water. They are geometry: closed forms of the range, known before any light is planned.

use imaging::Plane;
use optics::plan::{ErrorBound, Stage, StageId};
use optics::range::{farthest, is_hole};
use optics::setting::Setting;
use optics::turbidity;
use spec::{Fidelity, Frame};

use crate::planning::Assessment;

/// Nanoseconds per pixel.
const PATH_NS: f64 = 5.3;

/// Optical depths up to which errors are counted as a share of the light; of light behind more, which is faint, they are absolute.
const DEEPEST: f64 = 6.0;

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
    // In clear patches a path is shorter than the range that its rounding is a share of.
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

/// Mean, least and greatest path as a share of the range; `None` in a frame of holes.
pub(crate) fn factors(path: &Plane<f32>, range: &Plane<f32>) -> Option<[f64; 3]> {
    let pairs = path.data().iter().zip(range.data());
    let factors = pairs
        .filter(|(_, z)| !is_hole(**z))
        .map(|(path, z)| f64::from(*path) / f64::from(*z));
    let (mut count, mut sum, mut least, mut most) = (0.0, 0.0, f64::INFINITY, 0.0f64);
    for factor in factors {
        (count, sum) = (count + 1.0, sum + factor);
        (least, most) = (least.min(factor), most.max(factor));
    }
    (count > 0.0).then(|| [sum / count, least, most])
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
