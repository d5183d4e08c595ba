//! A coated steel pipe: field joints, weld seams under the coat, and damage that exposes steel.

use super::steel;
use super::surface::{Coat, Grain, Surface, SurfaceFinish, line};
use crate::categories::Finding;
use crate::site::lanes::{LANES, angle, clamp01, floor, mix, ramp};

/// Colors: black, green, blue, gray and brown.
pub(super) const COATS: [[f32; 3]; 5] = [
    [0.045, 0.047, 0.05],
    [0.07, 0.13, 0.09],
    [0.06, 0.11, 0.19],
    [0.27, 0.27, 0.26],
    [0.14, 0.085, 0.05],
];
const STEEL: [f32; 3] = [0.30, 0.29, 0.28];
/// Half the width of the girth weld and of the longitudinal seam, m.
const WELD_M: f32 = 0.011;
const SEAM_M: f32 = 0.008;

impl SurfaceFinish {
    /// The loop over the points, compiled by `vectorized!`.
    #[inline(always)]
    pub(super) fn coated(&self, coat: &Coat, grain: &Grain<'_>, surface: &mut Surface) {
        let SurfaceFinish { base, wear, .. } = *self;
        let Grain { points, broad, fine } = *grain;
        let (local, footprint) = (points.local, points.place.footprint);
        let Coat {
            radius,
            joint,
            pitch,
            band,
            band_color,
            seam,
        } = *coat;
        for i in 0..LANES {
            let (x, y) = (local[0][i], local[1][i]);
            let (speck, broad) = (fine.value[i], broad.value[i]);
            let place = (local[2][i] - joint) / pitch;
            let from_joint = (place - floor(place + 0.5)) * pitch;
            let away = from_joint.abs();
            let footprint = footprint[i];
            let sleeve = clamp01(0.5 + (band - away) / footprint);
            // The ends of a sleeve slope over a centimeter.
            let end = (away - band).abs();
            let step = (1.0 - ramp(end, 0.003, 0.012)) * if from_joint < 0.0 { -0.8 } else { 0.8 };
            let weld = line(away, WELD_M, footprint);
            let turned = angle(y, x) - seam;
            let arc = (turned - std::f32::consts::TAU * floor(turned / std::f32::consts::TAU + 0.5)) * radius;
            let outside = 1.0 - sleeve;
            let ridge = line(arc.abs(), SEAM_M, footprint) * outside;

            let attack = 0.85 * broad + 0.5 * speck + wear - 0.1 * sleeve;
            let damage = ramp(attack, 0.28, 0.36);
            let rust = ramp(attack + 0.25 * speck, 0.34, 0.6);
            let lifted = ramp(attack, 0.16, 0.3) * (1.0 - damage);
            let age = clamp01(0.5 + 0.6 * speck + 0.3 * broad);
            for c in 0..3 {
                let skin = mix(base[c], band_color[c], sleeve) * (1.0 + 0.15 * broad + 0.06 * speck);
                let metal = mix(STEEL[c] * (1.0 + 0.3 * speck), steel::rust_albedo(c, age), rust);
                let skin = mix(skin, 0.5 * skin + 0.16, 0.6 * lifted + 0.25 * ridge);
                surface.albedo[c][i] = mix(skin, metal * (1.0 + 0.2 * weld), damage);
            }
            let around = bead_slope(arc, SEAM_M, ridge, footprint);
            let along = bead_slope(from_joint, WELD_M, weld * (1.0 - 0.6 * sleeve), footprint) - step * 0.8;
            let rough = 0.0008 + 0.004 * damage;
            let rim = 3.2 * damage * (1.0 - damage);
            let slope = [-y / radius * around, x / radius * around, along];
            for axis in 0..3 {
                surface.slope[axis][i] = slope[axis] + (rough + 0.01 * rim) * fine.slope[axis][i];
            }
            surface.gloss[i] = 0.3 * (1.0 - damage);
            let findings = &mut surface.findings;
            findings[Finding::CoatingDamage as usize][i] = damage;
            findings[Finding::Corrosion as usize][i] = damage * rust;
            let jointed = (away < band) | (ridge > 0.3);
            findings[Finding::Joint as usize][i] = if jointed { 1.0 } else { 0.0 };
        }
    }
}

/// A weld bead is highest in its middle, where the slope changes sign.
#[inline(always)]
fn bead_slope(signed: f32, half: f32, part: f32, footprint: f32) -> f32 {
    -0.8 * part * signed / (half + 0.5 * footprint)
}
