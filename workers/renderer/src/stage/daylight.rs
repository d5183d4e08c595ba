//! Daylight on surfaces, and its shafts in the water in front of them.

mod assess;

pub(crate) use assess::{assess, effect_ns};

use std::borrow::Cow;

use imaging::rays::Rays;
use imaging::{Plane, Rgb};
use optics::chain::Layers;
use optics::daylight::{self, Daylight, RAYS_PER_CELL, Reaching, Refraction, SunLight, Surfaces};
use optics::lamp;
use optics::plan::{Plan, StageId, Variant};
use optics::range::of_surfaces;
use optics::setting::Setting;
use optics::water::Water;

use crate::context::FrameContext;
use crate::daylight_bounds::find_surface_daylight;
use crate::inputs::caustics::Pattern;
use crate::inputs::scene::Prepared;

/// A scene in daylight; `None` if it reaches no surface.
pub(crate) fn run(context: &FrameContext<'_>) -> Option<Rgb<f32>> {
    let FrameContext {
        prepared,
        setting,
        plan,
        ..
    } = context;
    let water = setting.water.as_ref()?;
    let daylight = find_surface_daylight(setting)?;
    let scene = &prepared.scene.radiance;
    let range = &*of_surfaces(prepared.scene.range.as_ref()?, water.holes());
    let normals = normals(prepared, range, setting);
    let surfaces = Surfaces {
        range,
        normals: &normals,
        objects: prepared.scene.instances.as_ref(),
    };
    let pattern = context.pattern.as_ref();
    let sunlight = daylight
        .sun()
        .and_then(|sun| sunlight(plan, surfaces, (daylight, sun), context.rays(), pattern));
    let attenuation = Water::direct_attenuation(water);
    let access = match (plan.variant(StageId::AmbientAccess), context.rays()) {
        (Variant::Skip, _) | (_, None) => None,
        (Variant::Reference, Some(rays)) => {
            Some(daylight::access_reference(surfaces, daylight, attenuation, rays))
        }
        (_, Some(rays)) => Some(daylight::access(surfaces, daylight, attenuation, rays)),
    };
    let reaching = Reaching {
        sunlight: sunlight.as_ref(),
        access: access.as_ref(),
    };
    if *plan.variant(StageId::Surfaces) == Variant::Reference {
        let exact = daylight::surfaces_reference(
            &scene.map(|&v| f64::from(v)),
            &range.map(|&z| f64::from(z)),
            &normals.each_ref().map(|axis| axis.map(|&v| f64::from(v))),
            daylight,
            reaching,
        );
        return Some(exact.map(|&v| v as f32));
    }
    Some(daylight::surfaces(scene, range, &normals, daylight, reaching))
}

/// Share of the sunlight that reaches each surface; `None` if all surfaces are fully lit.
fn sunlight(
    plan: &Plan,
    surfaces: Surfaces<'_>,
    (daylight, sun): (&Daylight, &SunLight),
    rays: Option<&dyn Rays>,
    pattern: Option<&Pattern>,
) -> Option<Plane<f32>> {
    let seen = match (plan.variant(StageId::SunShadow), rays) {
        (Variant::Skip, _) | (_, None) => None,
        (Variant::Reference, Some(rays)) => Some(daylight::sunlit_reference(surfaces, daylight, sun, rays)),
        (_, Some(rays)) => Some(daylight::sunlit(surfaces, daylight, sun, rays)),
    };
    let caustics = plan.variant(StageId::Caustics);
    let Some(pattern) = pattern.filter(|_| !caustics.is_skipped()) else {
        return seen;
    };
    let (width, height) = surfaces.range.size();
    let mut light = seen.unwrap_or_else(|| Plane::filled(width, height, 1.0));
    let Pattern { waves, blur, tiles } = pattern;
    if *caustics != Variant::Reference {
        daylight::caustics(surfaces.range, daylight, sun, tiles, &mut light);
        return Some(light);
    }
    let exact = |&depth: &f64| daylight::tile_reference(waves, blur, depth, RAYS_PER_CELL, Refraction::Small);
    let exact: Vec<_> = tiles.depths_m().iter().map(exact).collect();
    let range = surfaces.range.map(|&z| f64::from(z));
    let factor = daylight::caustics_reference(&range, daylight, waves, (&exact, tiles.depths_m()));
    for (light, factor) in light.data_mut().iter_mut().zip(factor.data()) {
        *light *= *factor as f32;
    }
    Some(light)
}

/// Occludes the veil of daylight, and modulates it by the wave pattern.
pub(crate) fn run_in_water(context: &FrameContext<'_>, layers: &mut Layers) {
    occlude_veil(context, layers);
    add_shafts(context, layers);
}

fn occlude_veil(context: &FrameContext<'_>, layers: &mut Layers) {
    let Some(water) = &context.setting.water else {
        return;
    };
    let daylight = water.daylight().filter(|daylight| daylight.occludes_veil());
    let (Some(daylight), Some(range), Some(rays)) = (daylight, &context.prepared.scene.range, context.rays())
    else {
        return;
    };
    let access = match context.plan.variant(StageId::VeilOcclusion) {
        Variant::Skip => return,
        Variant::Reference => daylight::veil_access_reference(range, daylight, rays),
        _ => daylight::veil_access(range, daylight, rays),
    };
    daylight::occlude_veil(&mut layers.backscatter, &mut layers.scattered, &access);
}

/// Adds the wave pattern to the veil, for frames with shafts.
fn add_shafts(context: &FrameContext<'_>, layers: &mut Layers) {
    let setting = &context.setting;
    let daylight = setting.water.as_ref().and_then(Water::daylight);
    let daylight = daylight.filter(|daylight| daylight.has_shafts());
    let (Some(pattern), Some(daylight), Some(path)) = (&context.pattern, daylight, context.path()) else {
        return;
    };
    let Some(sun) = daylight.sun() else { return };
    // Per length of the range, as the range is.
    let attenuation = pattern.blur.attenuation * daylight.scale();
    let shafts = daylight::shafts(path, daylight, sun, &pattern.tiles, attenuation);
    daylight::with_shafts(&mut layers.backscatter, &mut layers.scattered, &shafts, daylight);
}

/// Normals of the scene, or computed from its range.
fn normals<'a>(prepared: &'a Prepared, range: &Plane<f32>, setting: &Setting) -> Cow<'a, [Plane<f32>; 3]> {
    match &prepared.scene.normals {
        Some(normals) => Cow::Borrowed(normals),
        None => Cow::Owned(lamp::normals_of(range, &setting.eye.camera)),
    }
}
