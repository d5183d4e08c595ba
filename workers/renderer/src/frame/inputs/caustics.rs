//! The pattern of caustics of a frame.

use std::sync::Arc;

use imaging::Plane;
use optics::daylight::{self, Blur, SurfaceLight, Tiles, Waves};
use optics::range::of_surfaces;
use optics::setting::Setting;
use spec::Frame;

/// Waves above the scene and their light at several depths.
pub(crate) struct Pattern {
    pub(crate) waves: Waves,
    pub(crate) blur: Blur,
    pub(crate) tiles: Arc<Tiles>,
}

/// The tiles of the last frame, reused if place, time and water are the same.
#[derive(Default)]
pub(crate) struct LastTiles(Option<Arc<Tiles>>);

impl LastTiles {
    fn find(&mut self, waves: &Waves, blur: &Blur, depths_m: Vec<f64>) -> Arc<Tiles> {
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

/// The caustic pattern of a frame, or `None` if neither surfaces nor shafts show it.
pub(crate) fn find_pattern(
    frame: &Frame,
    setting: &Setting,
    range: &Plane<f32>,
    last: &mut LastTiles,
) -> Option<Pattern> {
    let (waves, blur) = find_waves(frame, setting)?;
    let depths = find_slices(setting, range)?;
    let tiles = last.find(&waves, &blur, depths);
    Some(Pattern { waves, blur, tiles })
}

/// The caustic pattern of a frame on tiles of `cells` × `cells`.
pub(crate) fn find_coarse_tiles(
    frame: &Frame,
    setting: &Setting,
    range: &Plane<f32>,
    cells: usize,
) -> Option<Tiles> {
    let (waves, blur) = find_waves(frame, setting)?;
    let depths = find_slices(setting, range)?;
    Some(Tiles::new(&Waves { cells, ..waves }, &blur, depths))
}

fn find_waves(frame: &Frame, setting: &Setting) -> Option<(Waves, Blur)> {
    let daylight = setting.water.as_ref()?.daylight()?;
    let is_seen = daylight.surfaces() == SurfaceLight::Normal || daylight.has_shafts();
    let number = frame.camera.path.map_or(frame.index, |path| path.frame as u64);
    daylight.waves(frame.seed, number).filter(|_| is_seen)
}

/// Depths of the tiles, m. They cover the surfaces in view.
fn find_slices(setting: &Setting, range: &Plane<f32>) -> Option<Vec<f64>> {
    let water = setting.water.as_ref()?;
    let (shallowest, deepest) = water.daylight()?.depths_m(&of_surfaces(range, water.holes()))?;
    Some(daylight::slices(shallowest, deepest))
}
