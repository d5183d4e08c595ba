//! SurfaceRows: color, relief and defects from seeded noise in the solid's frame, so that the texture stays fixed while
//! the camera moves.
//!
//! Albedos are linear and between 0.02 and 0.8, as measured for wet and dry materials.

mod coat;
mod concrete;
mod grain;
mod growth;
mod pattern;
mod plain;
mod sand;
mod steel;
mod surface;

use imaging::vectorized;

use super::chance::Choices;
use super::lanes::{LANES, Lane, ZEROS, mix, ramp};
use super::lattice::NoiseSample;
use super::noise::Octaves;

use surface::Grain;
pub(crate) use surface::{Coat, Courses, JointPattern, Material, Points, Surface, SurfaceFinish, Unroll};

const PAINTS: [[f32; 3]; 7] = [
    [0.56, 0.36, 0.08],
    [0.44, 0.43, 0.40],
    [0.44, 0.17, 0.06],
    [0.08, 0.13, 0.20],
    [0.29, 0.31, 0.30],
    [0.55, 0.52, 0.43],
    [0.10, 0.16, 0.12],
];
const SILT: [f32; 3] = [0.22, 0.195, 0.15];

impl SurfaceFinish {
    /// Draws the parameters of a material.
    pub(crate) fn new(material: Material, dice: Choices) -> Self {
        let growth = match material {
            Material::Growth => 1.2,
            Material::Steel | Material::Coated(_) | Material::Concrete(_) => dice.uniform(3, -0.55, 0.5),
            Material::Stone | Material::Bag | Material::Rubber => dice.uniform(3, -0.4, 0.3),
            Material::Anode => -0.5,
            Material::Sand | Material::Body { .. } | Material::Bubble => -1.0,
        };
        Self {
            material,
            base: draw_albedo(material, dice),
            key: dice.key(4),
            wear: dice.uniform(5, -0.35, 0.45),
            growth,
            direction: dice.uniform(6, 0.0, 1.0),
            silt: match material {
                Material::Body { .. } | Material::Bubble => 0.0,
                _ => dice.uniform(11, 0.12, 0.8),
            },
            grain: 0.0,
        }
    }

    pub(crate) fn surface(&self, points: &Points<'_>) -> Surface {
        let mut surface = Surface::default();
        let place = &points.place;
        let broad = Octaves::even(1.3, 3, self.key);
        let broad = match self.material {
            Material::Stone | Material::Sand | Material::Growth | Material::Bag => place.noise(broad),
            _ => NoiseSample {
                value: place.values(broad),
                slope: [ZEROS; 3],
            },
        };
        let octaves = if self.material == Material::Sand { 3 } else { 2 };
        let fine = place.noise(Octaves::even(23.0, octaves, self.key ^ 0x51));
        let grain = &Grain {
            points,
            broad: &broad,
            fine: &fine,
        };
        match self.material {
            Material::Steel => self.steel(grain, &mut surface),
            Material::Coated(coat) => vectorized!(self.coated(&coat, grain, &mut surface)),
            Material::Concrete(pattern) => self.concrete(&pattern, grain, &mut surface),
            Material::Sand => self.sand(grain, &mut surface),
            _ => self.plain(grain, &mut surface),
        }
        if self.grain > 0.0 {
            self.strew(points, &mut surface);
        }
        if self.growth > -0.9 {
            self.overgrow(grain, &mut surface);
        }
        if let Material::Body { belly, .. } = self.material {
            vectorized!(lighten(&mut surface, belly, points.rise));
        }
        if self.material != Material::Sand && self.silt > 0.0 {
            vectorized!(settle(&mut surface, self.silt, points.rise, &broad.value));
        }
        surface
    }
}

/// Brightens the underside of animals (countershading).
#[inline(always)]
fn lighten(surface: &mut Surface, belly: f32, rise: &Lane) {
    for i in 0..LANES {
        let light = mix(belly, 1.0, ramp(rise[i], -0.7, 0.35));
        for c in 0..3 {
            surface.albedo[c][i] *= light;
        }
    }
}

/// Adds silt to upward surfaces.
#[inline(always)]
fn settle(surface: &mut Surface, most: f32, rise: &Lane, broad: &Lane) {
    for i in 0..LANES {
        let silt = most * (0.1 + 0.9 * ramp(rise[i] + 0.35 * broad[i], 0.25, 1.0));
        for c in 0..3 {
            surface.albedo[c][i] = mix(surface.albedo[c][i], SILT[c], silt);
        }
        surface.gloss[i] *= 1.0 - silt;
        let visible = 1.0 - 0.5 * silt;
        for axis in 0..3 {
            surface.slope[axis][i] *= visible;
        }
    }
}

fn draw_albedo(material: Material, dice: Choices) -> [f32; 3] {
    let base = match material {
        Material::Steel => dice.pick(2, &PAINTS),
        Material::Coated(_) => dice.pick(2, &coat::COATS),
        Material::Concrete(_) => [0.36, 0.34, 0.30],
        Material::Growth => dice.pick(2, &growth::WEED),
        Material::Anode => [0.56, 0.56, 0.53],
        Material::Stone => dice.pick(2, &[[0.22, 0.21, 0.19], [0.30, 0.24, 0.17], [0.13, 0.13, 0.14]]),
        Material::Rubber => [0.035, 0.035, 0.038],
        Material::Bag => dice.pick(2, &[[0.42, 0.38, 0.30], [0.30, 0.31, 0.26]]),
        Material::Body { color, .. } => color,
        Material::Bubble => return [0.42, 0.45, 0.47],
        Material::Sand => dice.pick(2, &[[0.38, 0.31, 0.21], [0.27, 0.25, 0.21], [0.20, 0.17, 0.13]]),
    };
    let light = dice.uniform(7, 0.8, 1.15);
    [0, 1, 2].map(|c| base[c] * light * dice.uniform(8 + c as u64, 0.93, 1.07))
}
