//! The pattern of caustics of a frame.

use std::sync::Arc;

use imaging::Plane;
use optics::daylight::{self, SurfaceLight, Blur, Tiles, Waves};
use optics::range::of_surfaces;
use optics::setting::Setting;
use spec::Frame;

/// Waves above the scene and their light at several depths.
pub(crate) struct Pattern {
    pub(crate) waves: Waves,
    pub(crate) blur: Blur,
    pub(crate) tiles: Arc<Tiles>,
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
pub(crate) fn find_pattern(
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
