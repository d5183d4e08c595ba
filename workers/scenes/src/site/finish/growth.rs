//! Biofouling: a thin film that grows into clumps of weed and mussels with ragged borders.

use imaging::vectorized;

use super::surface::{Grain, Surface, SurfaceFinish};
use crate::categories::Finding;
use crate::site::lanes::{LANES, Lane, ZEROS, clamp01, mix, ramp};
use crate::site::lattice::NoiseSample;
use crate::site::noise::Octaves;

pub(super) const WEED: [[f32; 3]; 4] = [
    [0.060, 0.072, 0.032],
    [0.10, 0.085, 0.05],
    [0.11, 0.062, 0.045],
    [0.075, 0.068, 0.045],
];
const FILM: [f32; 3] = [0.125, 0.115, 0.07];
const SHELL: [f32; 3] = [0.42, 0.39, 0.34];
/// Bare surface below this sum of choices.
const BARE: f32 = -0.3;
const DENSE: f32 = 0.8;

impl SurfaceFinish {
    pub(super) fn overgrow(&self, grain: &Grain<'_>, surface: &mut Surface) {
        let place = &grain.points.place;
        let patch = place.noise(Octaves::even(2.6, 2, self.key ^ 0x33));
        let mut density = ZEROS;
        vectorized!(thrive(&mut density, self.growth, &patch.value, grain));
        if density.iter().all(|&density| density <= BARE) {
            return;
        }
        let shells = place.dots(17.0, 0.3, 0.75, self.key ^ 0x99);
        let weeds = [self.key, self.key / 4].map(|choice| WEED[(choice % 4) as usize]);
        vectorized!(settle(weeds, &density, &patch, grain.fine, &shells, surface));
    }
}

/// Raises the density with the patch noise and on upward surfaces.
#[inline(always)]
fn thrive(density: &mut Lane, growth: f32, patch: &Lane, grain: &Grain<'_>) {
    let (broad, rise) = (&grain.broad.value, grain.points.rise);
    for i in 0..LANES {
        density[i] = 0.9 * patch[i] + 0.35 * broad[i] + 0.12 * rise[i] + growth;
    }
}

#[inline(always)]
fn settle(
    [young, old]: [[f32; 3]; 2],
    density: &Lane,
    patch: &NoiseSample,
    fine: &NoiseSample,
    shells: &NoiseSample,
    surface: &mut Surface,
) {
    for i in 0..LANES {
        let speck = fine.value[i];
        // Fine noise frays the border of a clump; its middle stays closed.
        let any = ramp(density[i], BARE, BARE + 0.15);
        let film = 0.72 * any * ramp(density[i] + 0.2 * speck, BARE, 0.45);
        let clump = any * ramp(density[i] + 0.6 * speck, 0.22, DENSE);
        let shell = shells.value[i] * ramp(density[i], -0.1, 0.5);
        let age = clamp01(0.5 + 0.8 * patch.value[i]);
        let light = 1.0 + 0.75 * speck;
        for c in 0..3 {
            let under = mix(surface.albedo[c][i], FILM[c] * (1.0 + 0.5 * speck), film);
            let weed = mix(young[c], old[c], age) * light;
            let grown = mix(under, weed, clump);
            surface.albedo[c][i] = mix(grown, SHELL[c], 0.6 * shell);
        }
        surface.gloss[i] *= 1.0 - film;
        for axis in 0..3 {
            let tufts = 0.03 * patch.slope[axis][i] + 0.007 * fine.slope[axis][i];
            surface.slope[axis][i] =
                mix(surface.slope[axis][i], tufts, clump) + 0.02 * shell * shells.slope[axis][i];
        }
        let hidden = 1.0 - ramp(clump, 0.3, 0.7);
        for finding in &mut surface.findings {
            finding[i] *= hidden;
        }
        surface.findings[Finding::Growth as usize][i] = clump;
    }
}
