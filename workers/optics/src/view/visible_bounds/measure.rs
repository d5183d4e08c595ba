//! Extremes of the pixels of each tile, in one pass.

use imaging::simd::{larger, smaller};
use imaging::{Plane, vectorized};

use crate::range::SHORTEST_M;

type Lanes = [f32; TILE_PX];

/// Extremes of the pixels of a tile.
#[derive(Clone, Copy)]
pub(super) struct Extremes {
    nearest: f32,
    farthest: f32,
    pub(super) has_holes: bool,
    pub(super) brightest: [f32; 3],
    pub(super) darkest: [f32; 3],
}

impl Extremes {
    pub(super) fn range_m(&self) -> Option<[f64; 2]> {
        (self.nearest <= self.farthest).then(|| [self.nearest, self.farthest].map(f64::from))
    }
}

/// The same of each column of a tile.
struct Columns {
    nearest: Lanes,
    farthest: Lanes,
    /// 1 where a pixel is a hole.
    hole: Lanes,
    brightest: [Lanes; 3],
    darkest: [Lanes; 3],
}

/// Extremes of all tiles, row by row. Without `light` the radiance is 1.
pub(super) fn extremes(range: &Plane<f32>, light: Option<[&[f32]; 3]>) -> Vec<Extremes> {
    let (width, height) = range.size();
    let mut all = Vec::with_capacity(width.div_ceil(TILE_PX) * height.div_ceil(TILE_PX));
    for top in (0..height).step_by(TILE_PX) {
        for left in (0..width).step_by(TILE_PX) {
            let mut columns = Columns::empty();
            for y in top..(top + TILE_PX).min(height) {
                let own = y * width + left..y * width + (left + TILE_PX).min(width);
                let range = &range.data()[own.clone()];
                vectorized!(columns.include_range(range));
                if let Some(light) = light {
                    let light = light.map(|plane| &plane[own.clone()]);
                    vectorized!(columns.include_light(light));
                }
            }
            all.push(columns.reduce(light.is_some()));
        }
    }
    all
}

impl Columns {
    fn empty() -> Self {
        Self {
            nearest: [f32::INFINITY; TILE_PX],
            farthest: [0.0; TILE_PX],
            hole: [0.0; TILE_PX],
            brightest: [[0.0; TILE_PX]; 3],
            darkest: [[f32::INFINITY; TILE_PX]; 3],
        }
    }

    #[inline(always)]
    fn include_range(&mut self, range: &[f32]) {
        let count = range.len().min(TILE_PX);
        for i in 0..count {
            let z = range[i];
            let is_surface = (z >= SHORTEST_M as f32) & (z <= f32::MAX);
            self.nearest[i] = smaller(if is_surface { z } else { f32::INFINITY }, self.nearest[i]);
            self.farthest[i] = larger(if is_surface { z } else { 0.0 }, self.farthest[i]);
            self.hole[i] = if is_surface { self.hole[i] } else { 1.0 };
        }
    }

    #[inline(always)]
    fn include_light(&mut self, light: [&[f32]; 3]) {
        for ((light, brightest), darkest) in light.iter().zip(&mut self.brightest).zip(&mut self.darkest) {
            let count = light.len().min(TILE_PX);
            for i in 0..count {
                brightest[i] = larger(light[i], brightest[i]);
                darkest[i] = smaller(light[i], darkest[i]);
            }
        }
    }

    fn reduce(&self, has_light: bool) -> Extremes {
        let least = |lanes: &Lanes| lanes.iter().copied().fold(f32::INFINITY, f32::min);
        let most = |lanes: &Lanes| lanes.iter().copied().fold(0.0, f32::max);
        let [mut brightest, mut darkest] = [[1.0; 3]; 2];
        if has_light {
            brightest = self.brightest.each_ref().map(most);
            darkest = self.darkest.each_ref().map(least);
        }
        Extremes {
            nearest: least(&self.nearest),
            farthest: most(&self.farthest),
            has_holes: most(&self.hole) > 0.0,
            brightest,
            darkest,
        }
    }
}

/// Columns and rows of a tile.
pub const TILE_PX: usize = 32;
