//! The haze of the lights over the styled picture.

use std::borrow::Cow;

use imaging::Rgb;
use optics::plan::{Stage, StageId, Variant};
use spec::Haze;

use super::camera;
use crate::assessment::Assessment;
use crate::context::FrameContext;

/// Nanoseconds per pixel of each light.
const HAZE_NS: f64 = 5.0;

/// Plans the haze of the visible lights.
pub(crate) fn assess(assessment: &Assessment<'_>) -> Stage {
    let lights = assessment.context.frame.haze();
    if !lights.iter().any(Haze::shines) {
        return Stage::skipped(StageId::Haze);
    }
    Stage::new(StageId::Haze, Variant::Fast("overlay"))
        .costing(HAZE_NS * lights.len() as f64, assessment.pixels())
}

/// Adds the haze to a picture, which is returned uncopied if no light shines.
pub(crate) fn run<'a>(context: &FrameContext<'_>, styled: &'a Rgb<f32>) -> Cow<'a, Rgb<f32>> {
    let haze = camera::haze_behind(context.frame, context.taking.is_some());
    if context.plan.variant(StageId::Haze).is_skipped() || haze.is_empty() {
        return Cow::Borrowed(styled);
    }
    Cow::Owned(optics::haze(styled.clone(), &haze))
}
