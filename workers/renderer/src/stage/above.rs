//! Light from above on surfaces and, as shafts, in the water before them.

use std::borrow::Cow;
use std::sync::Arc;

use imaging::rays::Rays;
use imaging::{Plane, Rgb};
use optics::chain::Layers;
use optics::daylight::{
    self, Blur, Daylight, RAYS_PER_CELL, Reaching, Refraction, SunLight, Surfaces, Tiles, Waves,
};
use optics::lamp;
use optics::plan::{Above, Form};
use optics::range::{farthest, of_surfaces};
use optics::setting::Setting;
use optics::water::Water;
use spec::{Frame, RaySource, SurfaceLight};

use super::rays;
use super::scene::Prepared;

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

/// A scene in the light from above, and how it was computed; none where it falls on no surface.
pub(crate) fn light(
    frame: &Frame,
    prepared: &Prepared,
    setting: &Setting,
    pattern: Option<&Pattern>,
) -> Option<(Rgb<f32>, Above)> {
    let water = setting.water.as_ref()?;
    let daylight = water.daylight()?;
    if daylight.surfaces() == SurfaceLight::None {
        return None;
    }
    let scene = &prepared.scene.radiance;
    let range = &*of_surfaces(prepared.scene.range.as_ref()?, water.holes());
    let farthest = farthest(range).unwrap_or(0.0);
    let brightest = optics::brightest(scene);
    let by_screen = frame.ray_source() == RaySource::Screen;
    let peak = pattern.map(|pattern| pattern.tiles.peak());
    let mut above = Above::choose(frame, setting, (brightest, peak), farthest, by_screen)?;
    let normals = normals(prepared, range, setting, daylight);
    let surfaces = Surfaces {
        range,
        normals: &normals,
        objects: prepared.scene.instances.as_ref(),
    };
    let asks = above.shadow.is_some() || above.access.is_some();
    let rays = asks.then(|| rays::scene_rays(frame, prepared)).flatten();
    let rays = rays.as_deref().map(|rays| rays as &dyn Rays);
    let sunlight = daylight
        .sun()
        .and_then(|sun| sunlight(&above, surfaces, (daylight, sun), rays, pattern));
    let access = rays.zip(above.access.as_ref());
    let attenuation = Water::direct_attenuation(water);
    let access = access.map(|(rays, stage)| match stage.form {
        Form::Reference => daylight::access_reference(surfaces, daylight, attenuation, rays),
        Form::Fast | Form::Skip => daylight::access(surfaces, daylight, attenuation, rays),
    });
    let reaching = Reaching {
        sunlight: sunlight.as_ref(),
        access: access.as_ref(),
    };
    if above.surfaces.form == Form::Reference {
        let exact = daylight::surfaces_reference(
            &scene.map(|&v| f64::from(v)),
            &range.map(|&z| f64::from(z)),
            &normals.each_ref().map(|axis| axis.map(|&v| f64::from(v))),
            daylight,
            reaching,
        );
        return Some((exact.map(|&v| v as f32), above));
    }
    let lit = daylight::surfaces(scene, range, &normals, daylight, reaching);
    above.surfaces.bound = Some(daylight::surfaces_rounding(daylight, &lit, farthest));
    Some((lit, above))
}

/// How much of the sun reaches each surface; none where all of it reaches all.
fn sunlight(
    above: &Above,
    surfaces: Surfaces<'_>,
    (daylight, sun): (&Daylight, &SunLight),
    rays: Option<&dyn Rays>,
    pattern: Option<&Pattern>,
) -> Option<Plane<f32>> {
    let form = |stage: &Option<optics::plan::Stage>| stage.as_ref().map_or(Form::Skip, |stage| stage.form);
    let seen = match (form(&above.shadow), rays) {
        (Form::Fast, Some(rays)) => Some(daylight::sunlit(surfaces, daylight, sun, rays)),
        (Form::Reference, Some(rays)) => Some(daylight::sunlit_reference(surfaces, daylight, sun, rays)),
        _ => None,
    };
    let (Some(pattern), true) = (pattern, form(&above.caustics) != Form::Skip) else {
        return seen;
    };
    let (width, height) = surfaces.range.size();
    let mut light = seen.unwrap_or_else(|| Plane::filled(width, height, 1.0));
    let Pattern { waves, blur, tiles } = pattern;
    if form(&above.caustics) == Form::Fast {
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

/// Lets the pattern show in the veil, where the frame asks for it.
pub(crate) fn shine_through(
    setting: &Setting,
    range: &Plane<f32>,
    pattern: Option<&Pattern>,
    layers: &mut Layers,
) {
    let daylight = setting.water.as_ref().and_then(Water::daylight);
    let (Some(pattern), Some(daylight)) = (pattern, daylight.filter(|daylight| daylight.has_shafts())) else {
        return;
    };
    let Some(sun) = daylight.sun() else { return };
    // Per length of the range, as the range is.
    let attenuation = pattern.blur.attenuation * daylight.scale();
    let shafts = daylight::shafts(range, daylight, sun, &pattern.tiles, attenuation);
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
