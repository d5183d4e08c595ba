//! Stone, anodes, rubber, bags and solid growth: one colour with mottles and relief.

use imaging::simd::vectorised;

use super::{Finish, Material, Surface};
use crate::site::lanes::LANES;
use crate::site::noise::Noise;

impl Finish {
    pub(super) fn plain(&self, broad: &Noise, fine: &Noise, surface: &mut Surface) {
        let (rough, coarse, mottle) = match self.material {
            Material::Stone => (0.004, 0.05, 0.35),
            Material::Growth => (0.006, 0.02, 0.5),
            Material::Bag => (0.005, 0.03, 0.2),
            Material::Rubber => (0.001, 0.0, 0.2),
            _ => (0.004, 0.0, 0.3),
        };
        let base = self.base;
        vectorised(
            #[inline(always)]
            || mottled(base, broad, fine, (rough, coarse, mottle), surface),
        );
    }
}

#[inline(always)]
fn mottled(
    base: [f32; 3],
    broad: &Noise,
    fine: &Noise,
    (rough, coarse, mottle): (f32, f32, f32),
    surface: &mut Surface,
) {
    for i in 0..LANES {
        let light = 1.0 + mottle * broad.value[i] + 0.3 * fine.value[i];
        for c in 0..3 {
            surface.albedo[c][i] = base[c] * light;
        }
        for axis in 0..3 {
            surface.slope[axis][i] = rough * fine.slope[axis][i] + coarse * broad.slope[axis][i];
        }
        surface.gloss[i] = 0.02;
    }
}
