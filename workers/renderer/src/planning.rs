//! The plan of a frame: every stage is assessed from cheap bounds before any light is computed.

use optics::lamp::{self, AirlightBounds, SurfaceBounds};
use optics::plan::{
    Budget, Conditions, ErrorBound, ModelError, Plan, SceneBounds, Stage, TileGains, brightest_behind,
    compose, frame_tolerance,
};
use optics::setting::Setting;
use optics::visible_bounds::TILE_PX;

use crate::assessment::Assessment;
use crate::context::FrameContext;
use crate::daylight_bounds::{self, TileDaylight};
use crate::engine::Engine;
use crate::error::RenderError;
use crate::pipeline;
use crate::stage::camera::Expected;
use crate::stage::{camera, enhance, haze, snow, style, truth};

/// How often the shares of stages are halved.
const MOST_HALVINGS: usize = 2;

/// Plans a moment of a frame for its expected exposure, within the bound of an earlier plan if there is one.
pub(crate) fn plan_frame(
    context: &FrameContext<'_>,
    expected: Option<Expected>,
    promised: Option<ErrorBound>,
    engine: &Engine,
) -> Result<Plan, RenderError> {
    let Setting { lighting, around, .. } = &context.setting;
    let seen = lighting.as_ref().zip(context.view.as_ref());
    let surfaces = seen.map(|(lighting, view)| lamp::bound_irradiance(lighting, view));
    let daylight = daylight_bounds::bound_tiles(context);
    let bounds = bound_scene(context, daylight.as_deref(), surfaces.as_ref());
    let tolerance = frame_tolerance(
        context.frame,
        &bounds,
        around.as_ref(),
        camera::hidden_error(context.frame),
    );
    let tolerance = tolerance.map(|tolerance| tolerance.scaled(context.effects.tolerance_factor()));
    let airlight = seen.map(|(lighting, view)| lamp::bound_airlight(lighting, view));
    let peak = brightest_light(context, &bounds, airlight.as_ref());
    let target = tolerance.map(|tolerance| promised.map_or(tolerance, |error| error.lesser(tolerance)));
    let optics = camera::assess_optics(context, expected, target, peak);
    let mut assessment = Assessment {
        context,
        daylight,
        airlight,
        surfaces,
        bounds,
        tolerance,
        budget: Budget::new(target, &optics),
    };
    let mut stages = assess_light(&mut assessment, target, &optics);
    stages.extend(optics);
    stages.extend([style::assess(&assessment, engine)?, haze::assess(&assessment)]);
    stages.extend(camera::assess_electronics(context));
    stages.extend(enhance::assess(
        context.frame,
        tolerance.map(|tolerance| tolerance.absolute),
    ));
    stages.extend(truth::assess(context));
    context.effects.annotate(&mut stages);
    stages.sort_by_key(|stage| stage.id);
    judge_models(&mut stages, &assessment);
    Ok(Plan { tolerance, stages })
}

/// Plans the light before the camera. If all bounds together exceed the tolerance, stages that may be more accurate get smaller
/// shares, unless even that is not enough.
fn assess_light(assessment: &mut Assessment<'_>, target: Option<ErrorBound>, camera: &[Stage]) -> Vec<Stage> {
    let stages = pipeline::assess(assessment);
    let is_within = |stages: &[Stage]| {
        let errors = compose(stages.iter().chain(camera).filter(|stage| stage.id.is_promised()));
        target.is_none_or(|target| errors.iter().all(|error| error.is_within(target)))
    };
    if is_within(&stages) {
        return stages;
    }
    for _ in 0..MOST_HALVINGS {
        assessment.budget = assessment.budget.halved();
        let accurate = pipeline::assess(assessment);
        if is_within(&accurate) {
            return accurate;
        }
    }
    stages
}

/// Upper bound on the light in front of the camera, including that of particles.
fn brightest_light(
    context: &FrameContext<'_>,
    bounds: &SceneBounds,
    airlight: Option<&AirlightBounds>,
) -> f64 {
    let airlight = airlight.map_or(0.0, AirlightBounds::brightest);
    let behind = brightest_behind(bounds, context.setting.around.as_ref(), airlight);
    behind.max(snow::bound_flakes(context))
}

/// The scene in the brightest possible light.
fn bound_scene(
    context: &FrameContext<'_>,
    daylight: Option<&[TileDaylight]>,
    lamps: Option<&SurfaceBounds>,
) -> SceneBounds {
    let radiance = &context.prepared.scene.radiance;
    let gains = bound_light(context, daylight, lamps);
    match (
        &context.setting.around,
        context.path(),
        gains.zip(context.view.as_ref()),
    ) {
        (Some(water), Some(path), Some((gains, view))) => {
            SceneBounds::predict(radiance, view, &gains, path, water)
        }
        (Some(water), Some(path), None) => SceneBounds::measure(radiance, path, water),
        (_, _, gains) => SceneBounds::in_air(radiance).brightened(gains.as_ref().map(|(gains, _)| gains)),
    }
}

/// Upper bound, tile by tile, on the factor that lamps and daylight apply to the radiance of a scene; `None` if it is unchanged.
fn bound_light(
    context: &FrameContext<'_>,
    daylight: Option<&[TileDaylight]>,
    lamps: Option<&SurfaceBounds>,
) -> Option<TileGains> {
    let view = context.view.as_ref()?;
    if lamps.is_none() && daylight.is_none() {
        return None;
    }
    let gain = context.setting.gain();
    let gains = (0..view.tiles.len()).map(|tile| {
        let added = lamps.map_or([0.0; 3], |lamps| lamps.irradiance[tile]);
        let around = daylight.map_or([gain; 2], |tiles| {
            [tiles[tile].most(), tiles[tile].root_mean_square()]
        });
        let [most, root_mean_square] =
            around.map(|around| [0, 1, 2].map(|i| (around[i] + added[i] / std::f64::consts::PI) as f32));
        (most, root_mean_square)
    });
    let (most, root_mean_square) = gains.unzip();
    Some(TileGains {
        side_px: TILE_PX,
        columns: view.columns,
        most,
        root_mean_square,
        least: if daylight.is_some() {
            [0.0; 3]
        } else {
            gain.map(|gain| gain as f32)
        },
    })
}

/// Records the model error of each stage.
fn judge_models(stages: &mut [Stage], assessment: &Assessment<'_>) {
    let setting = &assessment.context.setting;
    let Some(water) = &setting.around else { return };
    let conditions = Conditions {
        water,
        lighting: setting.lighting.as_ref(),
        patches: setting.patches.as_ref(),
        bounds: &assessment.bounds,
    };
    for stage in stages {
        stage.model_error = ModelError::measured(stage.id, &conditions);
    }
}
