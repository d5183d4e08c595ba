//! Painted steel: rusting chips, the stains around them, and streaks of rust below.

use imaging::vectorized;

use super::surface::{Grain, Surface, SurfaceFinish};
use crate::categories::Finding;
use crate::site::lanes::{LANES, Lane, clamp01, mix, ramp};
use crate::site::noise::{NoisePoints, Octaves};

const RUST_DARK: [f32; 3] = [0.085, 0.042, 0.026];
const RUST_BRIGHT: [f32; 3] = [0.235, 0.098, 0.038];
/// Transmittance of the rust streaks, a factor on the paint's albedo.
const STAIN: [f32; 3] = [0.78, 0.58, 0.42];

impl SurfaceFinish {
    pub(super) fn steel(&self, grain: &Grain<'_>, surface: &mut Surface) {
        let run = NoisePoints {
            position: grain.points.world,
            ..grain.points.place
        };
        let run = run.values(Octaves {
            per_meter: [7.0, 7.0, 0.5],
            count: 1,
            key: self.key ^ 0x6b,
        });
        vectorized!(paint(self, grain, &run, surface));
    }
}

#[inline(always)]
fn paint(finish: &SurfaceFinish, grain: &Grain<'_>, run: &Lane, surface: &mut Surface) {
    let SurfaceFinish { base, wear, .. } = *finish;
    let Grain { points, broad, fine } = *grain;
    let edge = points.edge;
    for i in 0..LANES {
        let (broad, speck, run) = (broad.value[i], fine.value[i], run[i]);
        let attack = 0.85 * broad + 0.4 * speck + 0.5 * edge[i] + 0.3 * run + wear;
        let rust = ramp(attack, 0.12, 0.4);
        let stain = 0.75 * ramp(attack + 0.35 * run, -0.35, 0.35);
        let age = clamp01(0.36 + 0.75 * speck + 0.4 * broad + 0.35 * run);
        let faded = 1.0 + 0.13 * broad + 0.08 * run;
        for c in 0..3 {
            let paint = base[c] * faded * mix(1.0, STAIN[c], stain);
            surface.albedo[c][i] = mix(paint, rust_albedo(c, age), rust);
        }
        // Paint is smooth, rust is scaly.
        let rough = 0.0009 + 0.006 * rust;
        for axis in 0..3 {
            surface.slope[axis][i] = rough * fine.slope[axis][i];
        }
        surface.gloss[i] = 0.22 * (1.0 - rust) * (1.0 - 0.6 * stain);
        surface.findings[Finding::Corrosion as usize][i] = rust;
    }
}

/// Albedo of rust in a band, from fresh to old.
#[inline(always)]
pub(super) fn rust_albedo(c: usize, age: f32) -> f32 {
    mix(RUST_DARK[c], RUST_BRIGHT[c], age)
}
