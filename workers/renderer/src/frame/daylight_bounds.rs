//! Upper bounds of daylight on surfaces, tile by tile of the view.

use optics::daylight::{Daylight, MostLight, Strength, SurfaceLight};
use optics::setting::Setting;
use spec::HoleRule;

use crate::context::FrameContext;

/// Even sunlight.
const EVEN: Strength = Strength {
    peak: 1.0,
    root_mean_square: 1.0,
};

/// Upper bounds of daylight on the surfaces of one tile.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TileDaylight {
    /// On a surface of reflectance 1, without caustics.
    pub(crate) light: [MostLight; 3],
    /// Of the caustics.
    pub(crate) caustics: Strength,
    /// Largest reflectance of each channel.
    pub(crate) reflectance: [f32; 3],
}

impl TileDaylight {
    /// The largest factor of the reflectance.
    pub(crate) fn most(&self) -> [f64; 3] {
        self.scale_sunlight(self.caustics.peak)
    }

    /// Root mean square of that factor.
    pub(crate) fn root_mean_square(&self) -> [f64; 3] {
        self.scale_sunlight(self.caustics.root_mean_square)
    }

    fn scale_sunlight(&self, factor: f64) -> [f64; 3] {
        self.light.map(|light| light.sunlit * factor + light.around)
    }
}

/// Bounds of each tile of the view, dark without surfaces; `None` if daylight reaches none.
pub(crate) fn bound_tiles(context: &FrameContext<'_>) -> Option<Vec<TileDaylight>> {
    let daylight = find_surface_daylight(&context.setting)?;
    let view = context.view.as_ref()?;
    let stand_in = find_stand_in(context);
    let pattern = context.pattern.as_ref();
    let tiles = view.tiles.iter().map(|tile| {
        let heights = daylight.tile_heights(tile, stand_in);
        let light = heights.map(|heights| [0, 1, 2].map(|channel| daylight.most_light(channel, heights)));
        let caustics = pattern.zip(heights).map(|(pattern, heights)| {
            let own = pattern.tiles.strength_between(daylight.depths_of(heights));
            // Caustics that are left out are even.
            Strength {
                peak: own.peak.max(1.0),
                root_mean_square: own.root_mean_square.max(1.0),
            }
        });
        TileDaylight {
            light: light.unwrap_or_default(),
            caustics: caustics.unwrap_or(EVEN),
            reflectance: tile.brightest,
        }
    });
    Some(tiles.collect())
}

/// The farthest surface in view, in the unit of the range; 0 without any.
pub(crate) fn farthest_surface(context: &FrameContext<'_>) -> f64 {
    let Some(view) = &context.view else { return 0.0 };
    let farthest = view.range_m().map_or(0.0, |[_, farthest]| farthest);
    let has_holes = view.tiles.iter().any(|tile| tile.has_holes);
    let filled = find_stand_in(context).filter(|_| has_holes);
    farthest.max(filled.unwrap_or_default())
}

/// The range of the surface that replaces holes.
fn find_stand_in(context: &FrameContext<'_>) -> Option<f64> {
    match context.setting.water.as_ref()?.holes() {
        HoleRule::RangeM(meters) => Some(meters),
        _ => None,
    }
}

/// Daylight on the surfaces of a frame; `None` if it reaches none.
pub(crate) fn find_surface_daylight(setting: &Setting) -> Option<&Daylight> {
    let daylight = setting.water.as_ref()?.daylight()?;
    (daylight.surfaces() != SurfaceLight::None).then_some(daylight)
}
