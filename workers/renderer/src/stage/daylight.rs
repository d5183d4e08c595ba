//! Daylight on surfaces and, as shafts, in the water before them.

use std::borrow::Cow;
use std::sync::Arc;

use imaging::rays::Rays;
use imaging::{Plane, Rgb};
use optics::chain::Layers;
use optics::daylight::{
    self, Blur, Daylight, RAYS_PER_CELL, Reaching, Refraction, SunLight, Surfaces, Tiles, Waves,
};
use optics::lamp;
use optics::plan::{ErrorBound, Plan, Stage, StageId, Variant};
use optics::range::{farthest, of_surfaces};
use optics::setting::Setting;
use optics::water::Water;
use spec::{Frame, RaySource, SurfaceLight};

use super::scene::Prepared;
use crate::context::FrameContext;
use crate::planning::Assessment;

/// Nanoseconds per pixel: daylight on surfaces under an even sky and with the sun, a ray to the sun, each ray of ambient occlusion where
/// some are traced, and caustics with the tiles that they are looked up in.
const OVERCAST_NS: f64 = 7.0;
const SUNNY_NS: f64 = 9.0;
const SUN_RAY_NS: f64 = 30.0;
const AMBIENT_RAY_NS: f64 = 20.0;
const CAUSTICS_NS: f64 = 40.0;
/// A ray through a range image; of those of ambient occlusion there is one for each fifth pixel.
const SCREEN_RAY_NS: f64 = 1_000.0;
/// Shadows of the sun and caustics are each left out if that changes no more than this part of the tolerance.
const SKIP_SHARE: f64 = 0.0625;

/// The pattern of caustics of a frame.
pub(crate) struct Pattern {
    waves: Waves,
    blur: Blur,
    tiles: Arc<Tiles>,
}

impl Pattern {
    /// Its brightest place.
    pub(crate) fn peak(&self) -> f64 {
        self.tiles.peak()
    }

    /// Its root mean square over that.
    pub(crate) fn evenness(&self) -> f64 {
        self.tiles.root_mean_square() / self.tiles.peak().max(f64::MIN_POSITIVE)
    }
}

/// The tiles of the last frame: another one of the same place, time and water has the same.
#[derive(Default)]
pub(crate) struct LastTiles(Option<Arc<Tiles>>);

impl LastTiles {
    fn of(&mut self, waves: &Waves, blur: &Blur, depths_m: Vec<f64>) -> Arc<Tiles> {
        match &self.0 {
            Some(tiles) if tiles.are(waves, blur, &depths_m) => Arc::clone(tiles),
            _ => {
                let tiles = Arc::new(Tiles::new(waves, blur, depths_m));
                self.0 = Some(Arc::clone(&tiles));
                tiles
            }
        }
    }
}

/// The pattern that a frame asks for; none where nothing shows it.
pub(crate) fn pattern(
    frame: &Frame,
    setting: &Setting,
    range: &Plane<f32>,
    last: &mut LastTiles,
) -> Option<Pattern> {
    let water = setting.water.as_ref()?;
    let daylight = water.daylight()?;
    let number = frame.camera.path.map_or(frame.index, |path| path.frame as u64);
    let (waves, blur) = daylight.waves(frame.seed, number)?;
    let is_seen = daylight.surfaces() == SurfaceLight::Normal || daylight.has_shafts();
    let (shallowest, deepest) = daylight
        .depths_m(&of_surfaces(range, water.holes()))
        .filter(|_| is_seen)?;
    let depths = daylight::slices(shallowest, deepest);
    let tiles = last.of(&waves, &blur, depths);
    Some(Pattern { waves, blur, tiles })
}

/// Daylight of a frame on surfaces; `None` without, or if it falls on none.
fn on_surfaces(setting: &Setting) -> Option<&Daylight> {
    let daylight = setting.water.as_ref()?.daylight()?;
    (daylight.surfaces() != SurfaceLight::None).then_some(daylight)
}

/// By how much daylight multiplies the reflectance of a surface at most; `None` if it falls on none.
pub(crate) fn bound_light(context: &FrameContext<'_>) -> Option<[f64; 3]> {
    let daylight = on_surfaces(&context.setting)?;
    let far = farthest_surface(context)?;
    let peak = context
        .pattern
        .as_ref()
        .map_or(1.0, |pattern| pattern.peak().max(1.0));
    Some([0, 1, 2].map(|channel| daylight.most_light(channel, far, peak)))
}

fn farthest_surface(context: &FrameContext<'_>) -> Option<f64> {
    let water = context.setting.water.as_ref()?;
    let range = context.prepared.scene.range.as_ref()?;
    Some(farthest(&of_surfaces(range, water.holes())).unwrap_or(0.0))
}

/// Daylight on surfaces with the sun's shadows, ambient occlusion and caustics; or one factor for the whole scene.
pub(crate) fn assess(assessment: &Assessment<'_>) -> Vec<Stage> {
    let context = assessment.context;
    let (Some(daylight), Some(far)) = (on_surfaces(&context.setting), farthest_surface(context)) else {
        return vec![assess_factor(assessment)];
    };
    let is_sloped = daylight.surfaces() == SurfaceLight::Normal;
    let reflectance = optics::brightest(&context.prepared.scene.radiance);
    let peak = context
        .pattern
        .as_ref()
        .map_or(1.0, |pattern| pattern.peak().max(1.0));
    let sun = daylight.sun().filter(|_| is_sloped);
    let ns = if sun.is_some() { SUNNY_NS } else { OVERCAST_NS };
    let surfaces = Stage {
        bound: Some(daylight.rounding(reflectance, far, peak)),
        ..Stage::new(
            StageId::Surfaces,
            assessment.variant(if is_sloped { "by_normal" } else { "by_depth" }),
        )
    };
    let sunlight = (0..3).map(|c| f64::from(reflectance[c]) * daylight.most_sunlight(c, far));
    let sunlight = sunlight.fold(0.0, f64::max);
    let mut stages = vec![
        Stage::skipped(StageId::SceneLight),
        surfaces.costing(ns, assessment.pixels()),
    ];
    if sun.is_some_and(|sun| sun.casts_shadows) {
        stages.push(assess_sun_shadow(assessment, sunlight));
    }
    if is_sloped && daylight.ambient_rays() > 0 {
        stages.push(assess_ambient(assessment, daylight.ambient_rays()));
    }
    if sun.is_some() && context.pattern.is_some() {
        // Brighter by no more than the peak, and darker by no more than all of it.
        stages.push(assess_caustics(assessment, sunlight * (peak - 1.0).max(1.0)));
    }
    stages
}

/// One factor for each channel.
fn assess_factor(assessment: &Assessment<'_>) -> Stage {
    let gain = assessment.context.setting.gain();
    if [[0.0; 3], [1.0; 3]].contains(&gain) {
        return Stage::skipped(StageId::SceneLight);
    }
    Stage::new(StageId::SceneLight, Variant::Fast("daylight"))
}

fn is_by_screen(assessment: &Assessment<'_>) -> bool {
    assessment.context.frame.ray_source() == RaySource::Screen
}

/// A stage of sunlight: left out if that changes no more than its share.
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
    let by_screen = is_by_screen(assessment);
    let (variant, ns) = if by_screen {
        ("rays_of_range_image", SCREEN_RAY_NS)
    } else {
        ("rays", SUN_RAY_NS)
    };
    let mut stage = assess_sunlight(assessment, StageId::SunShadow, variant, sunlight);
    if !stage.variant.is_skipped() {
        stage.note = Some(if by_screen { OFF_SCREEN } else { EDGES }.to_owned());
    }
    stage.costing(ns, assessment.pixels())
}

const OFF_SCREEN: &str = "the error is not known: what the picture does not show casts no shadow";
const EDGES: &str = "at edges a pixel may fall on the other side";

fn assess_ambient(assessment: &Assessment<'_>, rays: usize) -> Stage {
    let by_screen = is_by_screen(assessment);
    let (variant, ns, note) = if by_screen {
        ("rays_of_range_image", SCREEN_RAY_NS / 5.0, OFF_SCREEN)
    } else {
        let note = "traced at every fourth pixel of one surface, at each pixel between surfaces";
        ("rays", AMBIENT_RAY_NS, note)
    };
    Stage {
        terms: Some(rays),
        bound: None,
        note: Some(note.to_owned()),
        ..Stage::new(StageId::AmbientAccess, assessment.variant(variant))
    }
    .costing(ns * rays as f64, assessment.pixels())
}

fn assess_caustics(assessment: &Assessment<'_>, changed: f64) -> Stage {
    assess_sunlight(assessment, StageId::Caustics, "tiles", changed).costing(CAUSTICS_NS, assessment.pixels())
}

/// A scene in daylight; `None` if it falls on no surface.
pub(crate) fn run(context: &FrameContext<'_>) -> Option<Rgb<f32>> {
    let FrameContext {
        prepared,
        setting,
        plan,
        ..
    } = context;
    let water = setting.water.as_ref()?;
    let daylight = on_surfaces(setting)?;
    let scene = &prepared.scene.radiance;
    let range = &*of_surfaces(prepared.scene.range.as_ref()?, water.holes());
    let normals = normals(prepared, range, setting, daylight);
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

/// How much of the sun reaches each surface; `None` if all of it reaches all.
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

/// Lets the pattern show in the veil, if the frame asks for it.
pub(crate) fn run_shafts(context: &FrameContext<'_>, layers: &mut Layers) {
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
    daylight::with_shafts(
        &mut layers.backscatter,
        &mut layers.scattered,
        &shafts,
        daylight,
        sun,
    );
}

/// Those of the scene, or of its range; none where daylight does not go by them.
fn normals<'a>(
    prepared: &'a Prepared,
    range: &Plane<f32>,
    setting: &Setting,
    daylight: &Daylight,
) -> Cow<'a, [Plane<f32>; 3]> {
    match &prepared.scene.normals {
        _ if daylight.surfaces() != SurfaceLight::Normal => {
            Cow::Owned([(); 3].map(|()| Plane::filled(0, 0, 0.0)))
        }
        Some(normals) => Cow::Borrowed(normals),
        None => Cow::Owned(lamp::normals_of(range, &setting.eye.camera)),
    }
}
