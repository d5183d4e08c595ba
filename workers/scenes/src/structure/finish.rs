//! Surfaces: colour and relief from seeded noise in the solid's own frame, so that nothing slides over a moving camera.
//!
//! Albedos are linear and lie between 0.02 and 0.8, as those of real wet and dry materials do.

use std::f32::consts::TAU;

use super::chance::Dice;
use super::lanes::{LANES, Lane, Lane3, ZEROS, cos_turns, mix, ramp, sin_turns};
use super::noise::{Octaves, Site};

/// What a surface is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Material {
    /// Painted steel, rusting from edges and scratches.
    Steel,
    /// Concrete with formwork lines and pores.
    Concrete,
    /// Covered with mussels and weed.
    Growth,
    /// A sacrificial anode, white with its own corrosion.
    Anode,
    /// Broken stone.
    Stone,
    /// The rippled seabed.
    Sand,
}

/// A material with the choices of one object.
#[derive(Debug, Clone, Copy)]
pub(super) struct Finish {
    material: Material,
    base: [f32; 3],
    key: u32,
    /// Share of rust or dirt, about 0..1.
    wear: f32,
    /// Share of growth, about 0..1.
    growth: f32,
    /// Direction of ripples or formwork, in turns.
    direction: f32,
}

/// Colour and relief of a group of points.
pub(super) struct Surface {
    pub(super) albedo: [Lane; 3],
    /// Slope of the relief, metres per metre.
    pub(super) slope: Lane3,
    pub(super) gloss: f32,
}

const PAINTS: [[f32; 3]; 7] = [
    [0.62, 0.36, 0.05],
    [0.46, 0.45, 0.42],
    [0.55, 0.19, 0.05],
    [0.07, 0.13, 0.22],
    [0.30, 0.32, 0.31],
    [0.60, 0.57, 0.48],
    [0.10, 0.16, 0.12],
];
const RUST: [f32; 3] = [0.17, 0.066, 0.028];
const WEED: [[f32; 3]; 3] = [[0.055, 0.075, 0.03], [0.10, 0.085, 0.05], [0.13, 0.06, 0.045]];

impl Finish {
    /// The surface of an object.
    pub(super) fn of(material: Material, dice: Dice) -> Self {
        let tint = |base: [f32; 3]| base.map(|c| c * dice.between(1, 0.75, 1.2));
        let base = match material {
            Material::Steel => tint(dice.pick(2, &PAINTS)),
            Material::Concrete => tint([0.36, 0.34, 0.30]),
            Material::Growth => tint(dice.pick(2, &WEED)),
            Material::Anode => tint([0.56, 0.56, 0.53]),
            Material::Stone => {
                tint(dice.pick(2, &[[0.22, 0.21, 0.19], [0.30, 0.24, 0.17], [0.13, 0.13, 0.14]]))
            }
            Material::Sand => {
                tint(dice.pick(2, &[[0.38, 0.31, 0.21], [0.27, 0.25, 0.21], [0.20, 0.17, 0.13]]))
            }
        };
        let growth = match material {
            Material::Growth => 1.2,
            Material::Steel | Material::Concrete => dice.between(3, -0.35, 0.65),
            Material::Anode => -0.3,
            Material::Stone => dice.between(3, -0.3, 0.3),
            Material::Sand => -1.0,
        };
        Self {
            material,
            base,
            key: dice.key(4),
            wear: dice.between(5, -0.35, 0.45),
            growth,
            direction: dice.between(6, 0.0, 1.0),
        }
    }

    /// The seabed of a site.
    pub(super) fn seabed(dice: Dice) -> Self {
        Self::of(Material::Sand, dice.object(1))
    }

    /// Colour and relief at some points of the solid's own frame; `edge` is how near an edge each is, 0..1.
    pub(super) fn surface(&self, site: &Site<'_>, edge: &Lane) -> Surface {
        let broad = site.noise(Octaves::even(1.3, 3, self.key));
        let fine = site.noise(Octaves::even(23.0, 2, self.key ^ 0x51));
        let mut surface = match self.material {
            Material::Sand => self.sand(site, &broad.value, &fine.value),
            Material::Steel => self.steel(&broad.value, &fine.value, edge),
            Material::Concrete => self.concrete(site, &broad.value, &fine.value),
            _ => self.plain(&broad.value, &fine.value),
        };
        let (rough, coarse) = match self.material {
            Material::Steel => (0.0016, 0.0),
            Material::Stone => (0.004, 0.05),
            Material::Sand => (0.0025, 0.012),
            Material::Growth => (0.006, 0.02),
            Material::Anode | Material::Concrete => (0.003, 0.004),
        };
        for axis in 0..3 {
            for i in 0..LANES {
                surface.slope[axis][i] += rough * fine.slope[axis][i] + coarse * broad.slope[axis][i];
            }
        }
        if self.growth > -0.5 {
            self.overgrow(site, &mut surface, &broad.value);
        }
        surface
    }

    fn plain(&self, broad: &Lane, fine: &Lane) -> Surface {
        let albedo = self
            .base
            .map(|c| each(|i| c * (1.0 + 0.35 * broad[i] + 0.3 * fine[i])));
        Surface {
            albedo,
            slope: [ZEROS; 3],
            gloss: 0.02,
        }
    }

    fn steel(&self, broad: &Lane, fine: &Lane, edge: &Lane) -> Surface {
        let rust = each(|i| {
            ramp(
                0.9 * broad[i] + 0.45 * fine[i] + 0.5 * edge[i] + self.wear,
                0.08,
                0.34,
            )
        });
        let streak = each(|i| 1.0 + 0.12 * broad[i]);
        let channel = |c: usize| {
            each(|i| {
                mix(
                    self.base[c] * streak[i],
                    RUST[c] * (1.0 + 0.9 * fine[i] + 0.4 * broad[i]),
                    rust[i],
                )
            })
        };
        Surface {
            albedo: [channel(0), channel(1), channel(2)],
            slope: [ZEROS; 3],
            gloss: 0.22,
        }
    }

    fn concrete(&self, site: &Site<'_>, broad: &Lane, fine: &Lane) -> Surface {
        // Boards of 0.45 m have left a seam each.
        const BOARD_PER_M: f32 = 2.2;
        let [_, _, z] = site.position;
        let seam = each(|i| {
            let place = z[i] * BOARD_PER_M + self.direction + 0.02 * broad[i];
            let away = (place - (place + 0.5).floor()).abs() / BOARD_PER_M;
            let visible = 1.0 - ramp(site.footprint[i], 0.01, 0.04);
            visible * (1.0 - ramp(away, 0.004, 0.016))
        });
        let pores = site.dots(26.0, 0.36, 0.45, self.key ^ 0x77);
        let stain = each(|i| ramp(broad[i] + self.wear, 0.1, 0.7));
        let shade = each(|i| 1.0 + 0.16 * broad[i] + 0.22 * fine[i] - 0.45 * seam[i] - 0.5 * pores.value[i]);
        let dirt = [0.62, 0.55, 0.42];
        let albedo = [0, 1, 2].map(|c| each(|i| self.base[c] * shade[i] * mix(1.0, dirt[c], stain[i])));
        let slope = pores.slope.map(|slope| each(|i| -0.006 * slope[i]));
        Surface {
            albedo,
            slope,
            gloss: 0.03,
        }
    }

    fn sand(&self, site: &Site<'_>, broad: &Lane, fine: &Lane) -> Surface {
        const RIPPLES_PER_M: f32 = 5.5;
        const HEIGHT_M: f32 = 0.009;
        let (across, along) = (cos_turns(self.direction), sin_turns(self.direction));
        let [x, y, _] = site.position;
        let phase = each(|i| RIPPLES_PER_M * (across * x[i] + along * y[i]) + 0.9 * broad[i]);
        let visible = each(|i| 1.0 - ramp(site.footprint[i] * RIPPLES_PER_M, 0.12, 0.45));
        let crest = each(|i| visible[i] * sin_turns(phase[i]));
        let steep = each(|i| visible[i] * HEIGHT_M * TAU * RIPPLES_PER_M * cos_turns(phase[i]));
        let albedo = self
            .base
            .map(|c| each(|i| c * (1.0 + 0.2 * broad[i] + 0.22 * fine[i] + 0.1 * crest[i])));
        Surface {
            albedo,
            slope: [each(|i| across * steep[i]), each(|i| along * steep[i]), ZEROS],
            gloss: 0.0,
        }
    }

    /// Patches of growth: dark, lumpy, with pale shells.
    fn overgrow(&self, site: &Site<'_>, surface: &mut Surface, broad: &Lane) {
        let patch = site.noise(Octaves::even(2.7, 3, self.key ^ 0x33));
        let cover = each(|i| ramp(patch.value[i] + 0.3 * broad[i] + self.growth, 0.28, 0.5));
        if cover.iter().all(|&cover| cover <= 0.0) {
            return;
        }
        let shells = site.dots(17.0, 0.42, 0.5, self.key ^ 0x99);
        let weed = WEED[(self.key % 3) as usize];
        for c in 0..3 {
            for i in 0..LANES {
                let shell = mix(
                    weed[c] * (1.0 + 0.8 * patch.value[i]),
                    [0.46, 0.43, 0.38][c],
                    0.55 * shells.value[i],
                );
                surface.albedo[c][i] = mix(surface.albedo[c][i], shell, cover[i]).clamp(0.02, 0.8);
            }
        }
        for axis in 0..3 {
            for i in 0..LANES {
                let lumps = 0.035 * patch.slope[axis][i] + 0.022 * shells.slope[axis][i];
                surface.slope[axis][i] += cover[i] * lumps;
            }
        }
    }
}

fn each(value: impl Fn(usize) -> f32) -> Lane {
    super::lanes::each(value)
}
