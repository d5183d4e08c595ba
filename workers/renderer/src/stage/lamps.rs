//! Light of lamps on surfaces.

use imaging::{Plane, Rgb};
use optics::daylight;
use optics::lamp::{self, Irradiance, Lighting, Shadow, SurfaceBounds};
use optics::plan::{Casting, ErrorBound, Shadows, Stage, StageId, Use, Variant};

use crate::assessment::Assessment;
use crate::context::FrameContext;

/// Costs in ns per pixel: normals and light of each lamp on surfaces, and the extra cost in turbid patches.
const SURFACE_NS: f64 = 6.6;
pub(super) const PATCHES_NS: f64 = 6.0;
/// Light of each lamp on a surface in f64.
const PRECISE_NS: f64 = 250.0;
/// Shadow rays to lamps: cost of one ray through a scene, maximum rays to a soft lamp, and rays to the disc of multiply scattered
/// light.
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
    let share = assessment.budget.lamp_rounding();
    let errors = tile_errors(assessment, bounds);
    let precise: Vec<bool> = errors.iter().map(|error| *error > share).collect();
    let count = precise.iter().filter(|is_precise| **is_precise).count();
    let part = count as f64 / precise.len().max(1) as f64;
    let ns = lighting.lamps.len() as f64 * (SURFACE_NS + patches + PRECISE_NS * part);
    let in_f32 = errors.into_iter().filter(|error| *error <= share);
    let light = Stage {
        share: Some(share),
        bound: Some(ErrorBound {
            absolute: in_f32.fold(0.0, f64::max),
            relative: lamp::LIT_ROUNDING,
        }),
        note: (count > 0).then(|| {
            format!(
                "{count} of {} tiles in f64, whose f32 may err by more than the share",
                precise.len()
            )
        }),
        ..Stage::new(
            StageId::Lamps,
            if count > 0 && !assessment.is_reference() {
                Variant::Tiled(precise)
            } else {
                assessment.variant("f32")
            },
        )
    };
    let mut stages = vec![light.costing(ns, assessment.pixels())];
    stages.extend(assess_shadows(assessment, lighting));
    stages
}

/// Rounding error of the light leaving surfaces in f32, tile by tile.
fn tile_errors(assessment: &Assessment<'_>, bounds: &SurfaceBounds) -> Vec<f64> {
    let tiles = assessment
        .context
        .view
        .as_ref()
        .map_or(&[][..], |view| view.tiles.as_slice());
    let errors = tiles.iter().zip(&bounds.rounding).map(|(tile, rounding)| {
        let reflectance = tile.brightest.into_iter().fold(0.0, f32::max);
        f64::from(reflectance) * rounding / std::f64::consts::PI
    });
    errors.collect()
}

fn assess_shadows(assessment: &Assessment<'_>, lighting: &Lighting) -> Option<Stage> {
    let context = assessment.context;
    let casting = needed_shadows(assessment, lighting);
    let rays = context.frame.ray_source();
    let shadows = Shadows::find(lighting, casting.as_ref(), Use::Surfaces, rays)?;
    let ns = shadows.lamps as f64 * rays_ns(lighting, shadows.samples);
    Some(shadow_stage(assessment, StageId::LampShadows, shadows).costing(ns, assessment.pixels()))
}

/// Expected cost of the shadows of all lamps on surfaces, ns per pixel.
pub(crate) fn shadow_ns(lighting: &Lighting) -> f64 {
    let each = lighting.lamps.iter().map(|lamp| match lamp.shadow() {
        Shadow::None => 0.0,
        Shadow::Hard => rays_ns(lighting, 1),
        Shadow::Soft { samples, .. } => rays_ns(lighting, samples),
    });
    each.sum()
}

/// Cost of the rays to one lamp of this many light samples, and to its multiply scattered light.
fn rays_ns(lighting: &Lighting, samples: usize) -> f64 {
    let discs = if lighting.absorption.is_some() {
        DISC_RAYS
    } else {
        0.0
    };
    (samples.min(SOFT_RAYS) as f64 + discs) * SHADOW_RAY_NS
}

/// The necessary shadows; `None` if the reference traces all of them as described.
pub(super) fn needed_shadows(assessment: &Assessment<'_>, lighting: &Lighting) -> Option<Casting> {
    let (rays, view) = (assessment.context.rays()?, assessment.context.view.as_ref()?);
    (!assessment.is_reference()).then(|| Casting::needed(assessment.budget.whole(), lighting, view, rays))
}

/// The stage of some shadows. No bound covers their edges.
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

/// The lit surfaces of a scene.
#[derive(Default)]
pub(crate) struct LitScene {
    /// Radiance of surfaces; `None` if it equals that of the scene.
    pub(crate) radiance: Option<Rgb<f32>>,
    /// Whether a lamp lights any surface.
    pub(crate) has_lamp_light: bool,
}

/// Adds lamplight to daylight on surfaces. The radiance of the scene in air is used as its reflectance.
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
    let precise = match context.plan.variant(StageId::Lamps) {
        Variant::Tiled(tiles) => tiles.as_slice(),
        _ => &[],
    };
    let (Some((needed, share)), Some(rays), Some(view)) = (cast, rays, &context.view) else {
        return lamp::irradiance_in_tiles(precise, range, &normals, lighting);
    };
    let lamp_share = share / lighting.lamps.len() as f64;
    let unseen = lamp::irradiance_of(view.brightest(), lamp_share);
    lamp::shaded_irradiance_in_tiles(precise, (range, &normals), needed, (rays, unseen))
}

/// Whether any sample is positive.
pub(crate) fn has_light(light: &Rgb<f32>) -> bool {
    light
        .planes()
        .iter()
        .any(|plane| plane.data().iter().any(|&v| v > 0.0))
}

/// Whether any of these lamps casts a shadow into the water.
pub(super) fn casts_into_water(lighting: &Lighting) -> bool {
    lighting
        .lamps
        .iter()
        .any(|lamp| lamp.casts_into_water() && lamp.shadow() != Shadow::None)
}
