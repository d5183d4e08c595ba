//! The seabed: ripples, mottles, shells and gravel.

use std::f32::consts::TAU;

use imaging::vectorized;

use super::surface::{Grain, Surface, SurfaceFinish};
use crate::site::lanes::{LANES, Lane, clamp01, cos_turns, mix, ramp, sin_turns};
use crate::site::lattice::NoiseSample;
use crate::site::noise::Octaves;

const RIPPLES_PER_M: f32 = 5.5;
const HEIGHT_M: f32 = 0.009;
const GRAVEL: [f32; 3] = [0.30, 0.285, 0.26];

impl SurfaceFinish {
    pub(super) fn sand(&self, grain: &Grain<'_>, surface: &mut Surface) {
        let place = &grain.points.place;
        // Ripples vanish in places, and the color varies over meters.
        let region = place.values(Octaves::even(0.37, 2, self.key ^ 0x17));
        let gravel = place.dots(16.0, 0.3, 0.8, self.key ^ 0x29);
        vectorized!(ripple(self, grain, &region, &gravel, surface));
    }
}

#[inline(always)]
fn ripple(
    finish: &SurfaceFinish,
    grain: &Grain<'_>,
    region: &Lane,
    gravel: &NoiseSample,
    surface: &mut Surface,
) {
    let SurfaceFinish {
        base,
        wear,
        direction,
        ..
    } = *finish;
    let Grain { points, broad, fine } = *grain;
    let (position, footprint) = (points.place.position, points.place.footprint);
    let (across, along) = (cos_turns(direction), sin_turns(direction));
    for i in 0..LANES {
        let (x, y) = (position[0][i], position[1][i]);
        let phase = RIPPLES_PER_M * (across * x + along * y) + 0.9 * broad.value[i] + 1.6 * region[i];
        let visible = 1.0 - ramp(footprint[i] * RIPPLES_PER_M, 0.12, 0.45);
        let strength = visible * (0.15 + 0.85 * ramp(region[i] - wear, -0.55, 0.35));
        let crest = strength * sin_turns(phase);
        let steep = strength * HEIGHT_M * TAU * RIPPLES_PER_M * cos_turns(phase);
        // Gravel and shells collect in the troughs and where there are no ripples.
        let scattered = 0.7 * broad.value[i] - 0.9 * region[i] - 0.5 * crest + wear;
        let pebble = gravel.value[i] * ramp(scattered, 0.05, 0.6);
        let light = 1.0 + 0.2 * broad.value[i] + 0.38 * fine.value[i] + 0.1 * crest;
        let damp = clamp01(0.5 + 0.7 * region[i]);
        for c in 0..3 {
            let sand = base[c] * light * mix(0.82, 1.12, damp);
            surface.albedo[c][i] = mix(sand, GRAVEL[c] * (1.0 + 0.8 * fine.value[i]), 0.8 * pebble);
        }
        let ripple = [across * steep, along * steep, 0.0];
        for axis in 0..3 {
            surface.slope[axis][i] = ripple[axis]
                + 0.0042 * fine.slope[axis][i]
                + 0.014 * broad.slope[axis][i]
                + 0.016 * pebble * gravel.slope[axis][i];
        }
    }
}
