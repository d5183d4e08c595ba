//! Second scale of texture: grains, shells and pebbles that show at close range.

use imaging::vectorized;

use super::surface::{Points, Surface, SurfaceFinish};
use crate::site::lanes::LANES;
use crate::site::lattice::NoiseSample;
use crate::site::noise::Octaves;

const SHELL: [f32; 3] = [0.55, 0.52, 0.46];

impl SurfaceFinish {
    pub(super) fn strew(&self, points: &Points<'_>, surface: &mut Surface) {
        let place = &points.place;
        let lumps = place.noise(Octaves::even(9.0, 2, self.key ^ 0x6b));
        let grains = place.noise(Octaves::even(130.0, 2, self.key ^ 0x77));
        let shells = place.dots(47.0, 0.34, 0.45, self.key ^ 0x85);
        vectorized!(scatter(self.grain, &lumps, &grains, &shells, surface));
    }
}

#[inline(always)]
fn scatter(
    strength: f32,
    lumps: &NoiseSample,
    grains: &NoiseSample,
    shells: &NoiseSample,
    surface: &mut Surface,
) {
    for i in 0..LANES {
        let light = 1.0 + strength * (0.55 * grains.value[i] + 0.35 * lumps.value[i]);
        let shell = 0.7 * strength * shells.value[i];
        for c in 0..3 {
            let grain = surface.albedo[c][i] * light;
            surface.albedo[c][i] = grain + (SHELL[c] - grain) * shell * shell;
        }
        for axis in 0..3 {
            surface.slope[axis][i] += strength
                * (0.0013 * grains.slope[axis][i]
                    + 0.011 * lumps.slope[axis][i]
                    + 0.006 * shells.slope[axis][i]);
        }
    }
}
