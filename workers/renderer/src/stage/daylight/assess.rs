//! The plan of daylight.

use optics::daylight::Daylight;
use optics::plan::{ErrorBound, Stage, StageId, Variant};
use optics::water::Water;
use spec::RaySource;

use crate::assessment::Assessment;
use crate::context::FrameContext;
use crate::daylight_bounds::{TileDaylight, farthest_surface, find_surface_daylight};

/// Costs in ns per pixel: daylight on surfaces under an overcast sky and with the sun, a sun ray, each ambient-occlusion ray if any
/// are traced, and caustics including their tiles.
const OVERCAST_NS: f64 = 7.0;
const SUNNY_NS: f64 = 9.0;
const SUN_RAY_NS: f64 = 30.0;
const AMBIENT_RAY_NS: f64 = 20.0;
const CAUSTICS_NS: f64 = 40.0;
const SHAFTS_NS: f64 = 12.0;
const VEIL_OCCLUSION_NS: f64 = 50.0;
/// A ray through a range image. Ambient occlusion traces its rays for every fifth pixel.
const SCREEN_RAY_NS: f64 = 1_000.0;
/// Largest part of the tolerance that omitting the sun's shadows, or caustics, may use.
const SKIP_SHARE: f64 = 0.0625;

/// Daylight of a frame on surfaces and in the water.
pub(crate) fn assess(assessment: &Assessment<'_>) -> Vec<Stage> {
    let mut stages = assess_surfaces(assessment);
    let daylight = assessment
        .context
        .setting
        .water
        .as_ref()
        .and_then(Water::daylight);
    let is_occluded = daylight.is_some_and(Daylight::occludes_veil) && assessment.context.rays().is_some();
    if is_occluded {
        let occlusion = Stage {
            bound: None,
            note: Some("traced between similar lines of sight for every 16th pixel at most".to_owned()),
            ..Stage::new(StageId::VeilOcclusion, assessment.variant("coarse_rays"))
        };
        stages.push(occlusion.costing(
            effect_ns(assessment.context, StageId::VeilOcclusion),
            assessment.pixels(),
        ));
    }
    stages
}

/// Daylight on surfaces with the sun's shadows, ambient occlusion and caustics; or one factor for the whole scene.
fn assess_surfaces(assessment: &Assessment<'_>) -> Vec<Stage> {
    let context = assessment.context;
    let (Some(daylight), Some(tiles)) = (find_surface_daylight(&context.setting), &assessment.daylight)
    else {
        return vec![assess_factor(assessment)];
    };
    let sun = daylight.sun();
    let ns = if sun.is_some() { SUNNY_NS } else { OVERCAST_NS };
    let surfaces = Stage {
        bound: Some(bound_rounding(assessment, daylight, tiles)),
        ..Stage::new(StageId::Surfaces, assessment.variant("by_normal"))
    };
    let sunlight = brightest(tiles, |tile, channel| tile.light[channel].sunlit);
    let mut stages = vec![
        Stage::skipped(StageId::SceneLight),
        surfaces.costing(ns, assessment.pixels()),
    ];
    if sun.is_some_and(|sun| sun.casts_shadows) {
        stages.push(assess_sun_shadow(assessment, sunlight));
    }
    if daylight.ambient_rays() > 0 {
        stages.push(assess_ambient(assessment, daylight.ambient_rays()));
    }
    if sun.is_some() && context.pattern.is_some() && daylight.draws_caustics() {
        // The pattern brightens by at most its peak, and darkens by at most all light.
        let changed = brightest(tiles, |tile, channel| {
            tile.light[channel].sunlit * (tile.caustics.peak - 1.0).max(1.0)
        });
        stages.push(assess_caustics(assessment, changed));
    }
    if sun.is_some() && context.pattern.is_some() && daylight.has_shafts() {
        let shafts = Stage {
            bound: None,
            ..Stage::new(StageId::Shafts, Variant::Fast("coarse_rays"))
        };
        stages.push(shafts.costing(effect_ns(context, StageId::Shafts), assessment.pixels()));
    }
    stages
}

/// The largest light of a kind on any surface.
fn brightest(tiles: &[TileDaylight], light: impl Fn(&TileDaylight, usize) -> f64) -> f64 {
    let lights = tiles.iter().flat_map(|tile| {
        let light = &light;
        (0..3).map(move |channel| f64::from(tile.reflectance[channel]) * light(tile, channel))
    });
    lights.fold(0.0, f64::max)
}

/// Bound of f32 rounding of daylight on surfaces.
fn bound_rounding(assessment: &Assessment<'_>, daylight: &Daylight, tiles: &[TileDaylight]) -> ErrorBound {
    let farthest = farthest_surface(assessment.context);
    let cosines = brightest(tiles, |tile, channel| {
        daylight.cosine_rounding(channel, tile.light[channel], tile.caustics.peak)
    });
    daylight.rounding(farthest).plus(ErrorBound::absolute(cosines))
}

/// One factor for each channel.
fn assess_factor(assessment: &Assessment<'_>) -> Stage {
    let gain = assessment.context.setting.gain();
    if [[0.0; 3], [1.0; 3]].contains(&gain) {
        return Stage::skipped(StageId::SceneLight);
    }
    Stage::new(StageId::SceneLight, Variant::Fast("daylight"))
}

fn is_by_screen(context: &FrameContext<'_>) -> bool {
    context.frame.ray_source() == RaySource::Screen
}

/// Expected cost of an effect of daylight, ns per pixel.
pub(crate) fn effect_ns(context: &FrameContext<'_>, id: StageId) -> f64 {
    let by_screen = is_by_screen(context);
    match id {
        StageId::SunShadow if by_screen => SCREEN_RAY_NS,
        StageId::SunShadow => SUN_RAY_NS,
        StageId::AmbientAccess => {
            let ray_ns = if by_screen {
                SCREEN_RAY_NS / 5.0
            } else {
                AMBIENT_RAY_NS
            };
            let daylight = context.setting.water.as_ref().and_then(Water::daylight);
            ray_ns * daylight.map_or(0, Daylight::ambient_rays) as f64
        }
        StageId::Caustics => CAUSTICS_NS,
        StageId::Shafts => SHAFTS_NS,
        StageId::VeilOcclusion => VEIL_OCCLUSION_NS,
        _ => 0.0,
    }
}

/// A stage of sunlight: skipped if its change is within its share.
fn assess_sunlight(assessment: &Assessment<'_>, id: StageId, fast: &'static str, changed: f64) -> Stage {
    let share = SKIP_SHARE * assessment.budget.whole();
    if !assessment.is_reference() && changed <= share {
        return Stage {
            share: Some(share),
            bound: Some(ErrorBound::absolute(changed)),
            note: Some("sunlight changes no more than its share".to_owned()),
            ..Stage::skipped(id)
        };
    }
    Stage {
        share: Some(share),
        bound: None,
        ..Stage::new(id, assessment.variant(fast))
    }
}

fn assess_sun_shadow(assessment: &Assessment<'_>, sunlight: f64) -> Stage {
    let by_screen = is_by_screen(assessment.context);
    let variant = if by_screen { "rays_of_range_image" } else { "rays" };
    let mut stage = assess_sunlight(assessment, StageId::SunShadow, variant, sunlight);
    if !stage.variant.is_skipped() {
        stage.note = Some(if by_screen { OFF_SCREEN } else { EDGES }.to_owned());
    }
    stage.costing(
        effect_ns(assessment.context, StageId::SunShadow),
        assessment.pixels(),
    )
}

const OFF_SCREEN: &str = "the error is not known: what the picture does not show casts no shadow";
const EDGES: &str = "at edges a pixel may fall on the other side";

fn assess_ambient(assessment: &Assessment<'_>, rays: usize) -> Stage {
    let (variant, note) = if is_by_screen(assessment.context) {
        ("rays_of_range_image", OFF_SCREEN)
    } else {
        let note = "traced at every fourth pixel of one surface, at each pixel between surfaces";
        ("rays", note)
    };
    Stage {
        terms: Some(rays),
        bound: None,
        note: Some(note.to_owned()),
        ..Stage::new(StageId::AmbientAccess, assessment.variant(variant))
    }
    .costing(
        effect_ns(assessment.context, StageId::AmbientAccess),
        assessment.pixels(),
    )
}

fn assess_caustics(assessment: &Assessment<'_>, changed: f64) -> Stage {
    let stage = assess_sunlight(assessment, StageId::Caustics, "tiles", changed);
    stage.costing(
        effect_ns(assessment.context, StageId::Caustics),
        assessment.pixels(),
    )
}
