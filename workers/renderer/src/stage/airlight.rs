//! Airlight of lamps: light that the water scatters towards the camera.

use imaging::{Plane, Rgb};
use optics::chain::Layers;
use optics::lamp::{self, Airlight, Lighting, REFERENCE_NODES};
use optics::plan::{Budget, ErrorBound, Stage, StageId, Use, Variant};

use super::lamps::{self, PATCHES_NS, SHADOW_RAY_NS};
use crate::assessment::Assessment;
use crate::context::FrameContext;

/// Nanoseconds per pixel of each lamp.
const AIRLIGHT_NS: f64 = 12.6;
/// Shadow rays of a pixel to each lamp, including those to the disc of multiply scattered light.
const RAYS: f64 = 10.0;
const DISC_RAYS: f64 = 7.0;

/// Part of the error budget for the quadrature; the remainder is for rounding.
const QUADRATURE: f64 = 0.5;
/// Relative rounding error of airlight computed in f64.
const ROUNDING: f64 = 6e-8;

/// Airlight and the shadows in it.
pub(crate) fn assess(assessment: &Assessment<'_>) -> Vec<Stage> {
    let lighting = assessment.context.setting.lighting.as_ref();
    let scattering = lighting.filter(|lighting| lighting.scattering != [0.0; 3]);
    let (Some(lighting), Some(bounds)) = (scattering, &assessment.airlight) else {
        return vec![Stage::skipped(StageId::Glow)];
    };
    let share = assessment.budget.airlight();
    let patches = if lighting.patches.is_some() {
        PATCHES_NS
    } else {
        0.0
    };
    // Pixels with a larger rounding error are computed in f64.
    let rounding = match lighting.absorption.is_none() && !lamps::casts_into_water(lighting) {
        true => {
            let most = bounds.rounding.bound_sample(bounds.brightest());
            ErrorBound::absolute(most.min((1.0 - QUADRATURE) * share))
        }
        false => bounds.rounding,
    };
    let relative_share = tolerated_share(lighting, assessment.budget);
    let light = Stage {
        share: Some(share),
        relative_share,
        bound: Some(rounding.plus(ErrorBound {
            absolute: QUADRATURE * share,
            relative: ROUNDING + relative_share,
        })),
        ..Stage::new(StageId::Glow, assessment.variant("quadrature"))
    };
    let ns = lighting.lamps.len() as f64 * (AIRLIGHT_NS + patches);
    let mut stages = vec![light.costing(ns, assessment.pixels())];
    stages.extend(assess_shadows(assessment, lighting));
    stages
}

/// The relative part of the airlight's tolerance: only the quadrature of multiple scattering without shadows uses one.
fn tolerated_share(lighting: &Lighting, budget: Budget) -> f64 {
    if lighting.absorption.is_some() && !lamps::casts_into_water(lighting) {
        budget.airlight_relative()
    } else {
        0.0
    }
}

fn assess_shadows(assessment: &Assessment<'_>, lighting: &Lighting) -> Option<Stage> {
    let casting = lamps::needed_shadows(assessment, lighting);
    let rays = assessment.context.frame.ray_source();
    let shadows = optics::plan::Shadows::find(lighting, casting.as_ref(), Use::Airlight, rays)?;
    let discs = if lighting.absorption.is_some() {
        DISC_RAYS
    } else {
        0.0
    };
    let ns = shadows.lamps as f64 * (RAYS + discs) * SHADOW_RAY_NS;
    let stage = lamps::shadow_stage(assessment, StageId::GlowShadows, shadows);
    Some(stage.costing(ns, assessment.pixels()))
}

/// The airlight of every pixel; `None` without lamps, or in water without scattering.
pub(crate) fn run(context: &FrameContext<'_>) -> Option<Rgb<f32>> {
    let (lighting, range) = (
        context.setting.lighting.as_ref()?,
        context.prepared.scene.range.as_ref()?,
    );
    let stage = context.plan.stage(StageId::Glow)?;
    match stage.variant {
        Variant::Skip => None,
        Variant::Reference => Some(run_reference(context, lighting, range)),
        _ if let Some(nodes) = context.airlight_nodes => {
            Some(lamp::airlight_with_nodes(range, lighting, nodes))
        }
        _ => Some(run_fast(context, lighting, range, stage).light),
    }
}

fn run_reference(context: &FrameContext<'_>, lighting: &Lighting, range: &Plane<f32>) -> Rgb<f32> {
    let range = range.map(|&z| f64::from(z));
    let light = match context.rays().filter(|_| lamps::casts_into_water(lighting)) {
        Some(rays) => lamp::shaded_airlight_reference(&range, lighting, REFERENCE_NODES, rays),
        None => lamp::airlight_reference(&range, lighting, REFERENCE_NODES),
    };
    light.map(|&v| v as f32)
}

fn run_fast(context: &FrameContext<'_>, lighting: &Lighting, range: &Plane<f32>, stage: &Stage) -> Airlight {
    let share = stage.share.unwrap_or_default();
    let tolerance = QUADRATURE * share;
    match (context.plan.variant(StageId::GlowShadows), context.rays()) {
        (Variant::Shadows(shadows), Some(rays)) if shadows.lamps > 0 => {
            lamp::shaded_airlight(range, &shadows.lighting, tolerance, rays)
        }
        _ => lamp::airlight_within(
            share - tolerance,
            range,
            lighting,
            ErrorBound {
                absolute: tolerance,
                relative: stage.relative_share,
            },
        ),
    }
}

/// Adds airlight to the picture and to its backscatter.
pub(crate) fn add(airlight: &Rgb<f32>, layers: &mut Layers) {
    for layer in [&mut layers.backscatter, &mut layers.scattered] {
        for (sums, added) in layer.planes_mut().into_iter().zip(airlight.planes()) {
            let pairs = sums.iter_mut().zip(added.data());
            pairs.for_each(|(sum, added)| *sum += added);
        }
    }
}
