//! Light of lamps on surfaces.

use imaging::{Plane, Rgb};
use optics::daylight;
use optics::lamp::{self, Irradiance, Lighting, Shadow, SurfaceBounds};
use optics::plan::{Casting, ErrorBound, Shadows, Stage, StageId, Use, Variant};

use crate::assessment::Assessment;
use crate::context::FrameContext;

/// Nanoseconds per pixel: normals and light of each lamp on surfaces, and the same in patches of turbidity on top.
const SURFACE_NS: f64 = 6.6;
pub(super) const PATCHES_NS: f64 = 6.0;
/// Each shadow ray to a lamp through a scene, the most to a soft lamp, and those to the disc of multiply scattered light.
pub(super) const SHADOW_RAY_NS: f64 = 17.5;
const SOFT_RAYS: usize = 3;
const DISC_RAYS: f64 = 0.6;

/// Lamps on surfaces and their shadows.
pub(crate) fn assess(assessment: &Assessment<'_>) -> Vec<Stage> {
    let (Some(lighting), Some(bounds)) = (&assessment.context.setting.lighting, &assessment.surfaces) else {
        return vec![Stage::skipped(StageId::Lamps)];
    };
    let patches = if lighting.patches.is_some() {
        PATCHES_NS
    } else {
        0.0
    };
    let ns = lighting.lamps.len() as f64 * (SURFACE_NS + patches);
    let share = assessment.budget.lamp_rounding();
    let light = Stage {
        share: Some(share),
        bound: Some(bound_light(assessment, bounds, share)),
        ..Stage::new(StageId::Lamps, assessment.variant("f32"))
    };
    let mut stages = vec![light.costing(ns, assessment.pixels())];
    stages.extend(assess_shadows(assessment, lighting));
    stages
}

/// Rounding of the light on surfaces, as it leaves them: at most `share`, because pixels that would lose more are computed in f64.
fn bound_light(assessment: &Assessment<'_>, bounds: &SurfaceBounds, share: f64) -> ErrorBound {
    let tiles = assessment
        .context
        .view
        .as_ref()
        .map_or(&[][..], |view| view.tiles.as_slice());
    let errors = tiles.iter().zip(&bounds.rounding).map(|(tile, rounding)| {
        let reflectance = tile.brightest.into_iter().fold(0.0, f32::max);
        f64::from(reflectance) * rounding / std::f64::consts::PI
    });
    ErrorBound {
        absolute: errors.fold(0.0, f64::max).min(share),
        relative: lamp::LIT_ROUNDING,
    }
}

fn assess_shadows(assessment: &Assessment<'_>, lighting: &Lighting) -> Option<Stage> {
    let context = assessment.context;
    let casting = needed_shadows(assessment, lighting);
    let rays = context.frame.ray_source();
    let shadows = Shadows::find(lighting, casting.as_ref(), Use::Surfaces, rays)?;
    let direct = shadows.samples.min(SOFT_RAYS) as f64;
    let discs = if lighting.absorption.is_some() {
        DISC_RAYS
    } else {
        0.0
    };
    let ns = shadows.lamps as f64 * (direct + discs) * SHADOW_RAY_NS;
    Some(shadow_stage(assessment, StageId::LampShadows, shadows).costing(ns, assessment.pixels()))
}

/// The necessary shadows; `None` if the reference casts all of them as described.
pub(super) fn needed_shadows(assessment: &Assessment<'_>, lighting: &Lighting) -> Option<Casting> {
    let (rays, view) = (assessment.context.rays()?, assessment.context.view.as_ref()?);
    (!assessment.is_reference()).then(|| Casting::needed(assessment.budget.whole(), lighting, view, rays))
}

/// The stage of some shadows, whose edges no bound counts.
pub(super) fn shadow_stage(assessment: &Assessment<'_>, id: StageId, shadows: Shadows) -> Stage {
    let is_cast = shadows.lamps > 0;
    Stage {
        terms: Some(shadows.lamps),
        share: (id == StageId::LampShadows).then(|| assessment.budget.unshadowed()),
        bound: (!is_cast).then_some(ErrorBound::EXACT),
        note: Some(shadows.note()),
        ..Stage::new(
            id,
            if assessment.is_reference() {
                Variant::Reference
            } else {
                Variant::Shadows(Box::new(shadows))
            },
        )
    }
}

/// The surfaces of a scene in their light.
#[derive(Default)]
pub(crate) struct LitScene {
    /// Radiance of surfaces; `None` if it is that of the scene.
    pub(crate) radiance: Option<Rgb<f32>>,
    /// Whether a lamp lights any of them.
    pub(crate) has_lamp_light: bool,
}

/// Adds the light of lamps on surfaces to daylight on them. The radiance of the scene in air stands for its reflectance.
pub(crate) fn run(context: &FrameContext<'_>, daylit: Option<Rgb<f32>>) -> LitScene {
    let setting = &context.setting;
    let (Some(lighting), Some(range)) = (&setting.lighting, &context.prepared.scene.range) else {
        return LitScene {
            radiance: daylit,
            has_lamp_light: false,
        };
    };
    let irradiance = shine(context, lighting, range);
    let reflectance = &context.prepared.scene.radiance;
    LitScene {
        radiance: Some(match daylit {
            Some(daylit) => daylight::with_lamps(daylit, reflectance, &irradiance.light),
            None => lamp::lit(reflectance, setting.gain(), &irradiance.light),
        }),
        has_lamp_light: has_light(&irradiance.light),
    }
}

fn shine(context: &FrameContext<'_>, lighting: &Lighting, range: &Plane<f32>) -> Irradiance {
    let normals = lamp::normals_of(range, &lighting.camera);
    let shadows = context.plan.stage(StageId::LampShadows);
    let rays = context.rays();
    if *context.plan.variant(StageId::Lamps) == Variant::Reference {
        let range = range.map(|&z| f64::from(z));
        let light = match rays.filter(|_| shadows.is_some()) {
            Some(rays) => lamp::shaded_irradiance_reference(&range, &normals, lighting, rays),
            None => lamp::irradiance_reference(&range, &normals, lighting),
        };
        return Irradiance {
            light: light.map(|&e| e as f32),
            rounding: 0.0,
        };
    }
    let cast = shadows.and_then(|stage| match &stage.variant {
        Variant::Shadows(shadows) if shadows.lamps > 0 => Some((&shadows.lighting, stage.share?)),
        _ => None,
    });
    let limit = context.plan.stage(StageId::Lamps).and_then(|stage| stage.share);
    let rounding = limit
        .zip(context.view.as_ref())
        .map_or(f64::INFINITY, |(share, view)| {
            lamp::irradiance_of(view.brightest(), share)
        });
    let (Some((needed, share)), Some(rays), Some(view)) = (cast, rays, &context.view) else {
        return lamp::irradiance_within(rounding, range, &normals, lighting);
    };
    let each = share / lighting.lamps.len() as f64;
    let unseen = lamp::irradiance_of(view.brightest(), each);
    lamp::shaded_irradiance_within(rounding, (range, &normals), needed, (rays, unseen))
}

/// Whether any sample is positive.
pub(crate) fn has_light(light: &Rgb<f32>) -> bool {
    light
        .planes()
        .iter()
        .any(|plane| plane.data().iter().any(|&v| v > 0.0))
}

/// Whether any lamp of these casts a shadow into the water.
pub(super) fn casts_into_water(lighting: &Lighting) -> bool {
    lighting
        .lamps
        .iter()
        .any(|lamp| lamp.casts_into_water() && lamp.shadow() != Shadow::None)
}
