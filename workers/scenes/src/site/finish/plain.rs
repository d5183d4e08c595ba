//! Stone, anodes, rubber, bags and solid growth: one color with mottles and relief.

use imaging::vectorized;

use super::surface::{Grain, Material, Surface, SurfaceFinish};
use crate::site::lanes::LANES;

impl SurfaceFinish {
    pub(super) fn plain(&self, grain: &Grain<'_>, surface: &mut Surface) {
        let weights = match self.material {
            Material::Stone => [0.004, 0.05, 0.35],
            Material::Growth => [0.006, 0.02, 0.5],
            Material::Bag => [0.005, 0.03, 0.2],
            Material::Rubber => [0.001, 0.0, 0.2],
            Material::Body { .. } => [0.0012, 0.0, 0.25],
            Material::Bubble => [0.0; 3],
            _ => [0.004, 0.0, 0.3],
        };
        let gloss = match self.material {
            Material::Body { gloss, .. } => gloss,
            Material::Bubble => 6.0,
            _ => 0.02,
        };
        vectorized!(mottle(self.base, grain, (weights, gloss), surface));
    }
}

/// `weights`: fine relief, broad relief and mottles; then the gloss.
#[inline(always)]
fn mottle(base: [f32; 3], grain: &Grain<'_>, (weights, gloss): ([f32; 3], f32), surface: &mut Surface) {
    let Grain { broad, fine, .. } = *grain;
    let [rough, coarse, mottles] = weights;
    for i in 0..LANES {
        let light = 1.0 + mottles * broad.value[i] + 0.3 * fine.value[i];
        for c in 0..3 {
            surface.albedo[c][i] = base[c] * light;
        }
        for axis in 0..3 {
            surface.slope[axis][i] = rough * fine.slope[axis][i] + coarse * broad.slope[axis][i];
        }
        surface.gloss[i] = gloss;
    }
}
