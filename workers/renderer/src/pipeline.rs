//! The light of one moment of a frame, from surfaces to the window of the camera: `I = D + F + B`, airlight and particles.

use optics::forward_scatter::KernelCache;
use optics::plan::Stage;
use optics::water::Water;
use spec::FrameRecord;

use crate::assessment::Assessment;
use crate::context::FrameContext;
use crate::error::RenderError;
use crate::light::Light;
use crate::stage::{airlight, daylight, lamps, sediment, snow, turbidity, water};
use crate::stopwatch::Stopwatch;

/// Plans the stages of a moment, in the order of light. The water gets the remainder of the tolerance.
pub(crate) fn assess(assessment: &Assessment<'_>) -> Vec<Stage> {
    let mut stages = daylight::assess(assessment);
    stages.push(turbidity::assess(assessment));
    stages.extend(lamps::assess(assessment));
    stages.extend(airlight::assess(assessment));
    stages.extend(sediment::assess(assessment));
    stages.push(snow::assess(assessment));
    stages.extend(water::assess(assessment, &stages));
    stages.sort_by_key(|stage| stage.id);
    stages
}

/// Renders a moment as planned. Adds the numbers and warnings of its stages to the record.
pub(crate) fn render(
    context: &FrameContext<'_>,
    kernels: &mut KernelCache,
    record: &mut FrameRecord,
    watch: &mut Stopwatch,
) -> Result<Light, RenderError> {
    let has_lamps = context.setting.lighting.is_some();
    let has_daylight = context.setting.water.as_ref().and_then(Water::daylight).is_some();
    let daylit = watch.time_if(has_daylight, "above", || daylight::run(context));
    let scene = watch.time_if(has_lamps, "lamps", || lamps::run(context, daylit));
    let radiance = scene
        .radiance
        .as_ref()
        .unwrap_or(&context.prepared.scene.radiance);
    let mut layers = watch.time("water", || water::run(context, radiance, kernels))?;
    watch.time("water", || daylight::run_in_water(context, &mut layers));
    let airlight = watch.time_if(has_lamps, "lamps", || airlight::run(context));
    if let Some(airlight) = &airlight {
        airlight::add(airlight, &mut layers);
    }
    if has_lamps && !scene.has_lamp_light && !airlight.as_ref().is_some_and(lamps::has_light) {
        record.warnings.push("no lamp lights anything in view".to_owned());
    }
    let picture = &mut layers.scattered;
    let mask = watch.time("snow", || {
        let clouded = sediment::run(context, picture, record);
        snow::run(context, clouded, picture, record)
    });
    Ok(Light {
        layers,
        airlight,
        mask,
    })
}
