//! Growth on surfaces: mussels, tube worms and hanging weed.

use imaging::vector::{Vec3, vec3};

use super::body::Skin;
use super::{Colony, GrowthSite, above_ground, direction, tangents};
use crate::categories::Category;
use crate::site::chance::Choices;
use crate::site::pose::{Pose, up};
use crate::site::solid::{Ellipsoid, Tube};

const SHELLS: [[f32; 3]; 3] = [[0.032, 0.034, 0.048], [0.06, 0.045, 0.035], [0.15, 0.13, 0.11]];
const TUBES: [[f32; 3]; 3] = [[0.46, 0.42, 0.35], [0.34, 0.29, 0.22], [0.5, 0.48, 0.44]];
const CROWNS: [[f32; 3]; 3] = [[0.42, 0.12, 0.06], [0.5, 0.4, 0.3], [0.3, 0.1, 0.14]];
const WEEDS: [[f32; 3]; 4] = [
    [0.055, 0.07, 0.022],
    [0.095, 0.07, 0.03],
    [0.12, 0.04, 0.035],
    [0.04, 0.06, 0.03],
];

impl Colony {
    /// A cluster of mussels: crowded upright shells with their pointed ends in the surface.
    pub(super) fn mussels(&mut self, dice: Choices, spot: &GrowthSite) {
        let color = dice.pick(1, &SHELLS);
        self.grow_on(
            spot,
            Skin {
                color,
                gloss: 0.25,
                belly: 1.0,
            },
            dice,
        );
        let [x, y] = tangents(spot.normal);
        let wide = dice.uniform(2, 0.04, 0.11);
        // Distant clusters are a few lumps.
        let count = match spot.range {
            near if near < 1.6 => dice.count(3, 9, 18),
            near if near < 3.0 => dice.count(3, 6, 10),
            _ => 3,
        };
        for shell in 0..count as u64 {
            let own = dice.object(dice_number(dice, shell));
            let grown = if count > 3 {
                own.uniform(0, 0.018, 0.036)
            } else {
                wide * 0.5
            };
            let out = (spot.normal + direction(own, 1) * 0.55).normalized();
            let (sin, cos) = libm::sincosf(own.uniform(3, 0.0, 6.3));
            let aside = wide * own.uniform(4, 0.0, 1.0).sqrt();
            let foot = spot.place + x * (aside * cos) + y * (aside * sin);
            let center = foot + out * (grown * 0.5);
            let pose = Pose::pointing(center, center + out, own.uniform(5, 0.0, 6.3));
            let radii = vec3(grown * 0.5, grown * 0.36, grown);
            self.builder.put(Ellipsoid { radii }, pose);
        }
    }

    /// A tuft of worms in chalk tubes, some with extended crowns.
    pub(super) fn worms(&mut self, dice: Choices, spot: &GrowthSite) {
        let color = dice.pick(1, &TUBES);
        self.grow_on(
            spot,
            Skin {
                color,
                gloss: 0.05,
                belly: 1.0,
            },
            dice,
        );
        let count = if spot.range < 2.5 { dice.count(2, 5, 10) } else { 3 };
        let [x, y] = tangents(spot.normal);
        let mut ends = Vec::new();
        for worm in 0..count as u64 {
            let own = dice.object(dice_number(dice, worm));
            let thick = own.uniform(0, 0.002, 0.0042) * if count == 3 { 1.6 } else { 1.0 };
            let foot = spot.place + x * own.uniform(1, -0.035, 0.035) + y * own.uniform(2, -0.035, 0.035);
            let mut heading = (spot.normal * 0.5 + direction(own, 3)).normalized();
            let mut start = foot - spot.normal * 0.003;
            for part in 0..3u64 {
                let target = start + heading * own.uniform(5 + part, 0.012, 0.035);
                self.limb(start, target, thick);
                heading = (heading + spot.normal * 0.55 + direction(own, 10 + 2 * part) * 0.5).normalized();
                start = target;
            }
            ends.push((start, thick));
        }
        if dice.chance(4, 0.6) && spot.range < 3.0 {
            let color = dice.pick(5, &CROWNS);
            self.grow_on(
                spot,
                Skin {
                    color,
                    gloss: 0.0,
                    belly: 1.0,
                },
                dice,
            );
            for (end, thick) in ends {
                let crown = vec3(thick, thick, thick) * 2.6;
                self.builder.ball(end, crown, 0.0);
            }
        }
    }

    /// A plant of several fronds. Fronds leave the surface, then hang and drift with the current; on upward surfaces
    /// they rise first.
    pub(super) fn weed(&mut self, dice: Choices, spot: &GrowthSite) {
        let color = dice.pick(1, &WEEDS);
        self.grow_on(
            spot,
            Skin {
                color,
                gloss: 0.08,
                belly: 0.8,
            },
            dice,
        );
        let long = dice.uniform(2, 0.12, 0.3) + 0.5 * dice.uniform(3, 0.0, 1.0) * dice.uniform(4, 0.0, 1.0);
        let parts = if spot.range < 3.0 { 6 } else { 4 };
        let fronds = if spot.range < 3.0 { dice.count(5, 4, 8) } else { 3 };
        let current = self.current();
        let hangs = if spot.normal.z > 0.6 { 0.35 } else { 1.0 };
        for frond in 0..fronds as u64 {
            let own = dice.object(dice_number(dice, frond));
            let mut start = spot.place;
            let mut heading = (spot.normal + direction(own, 0) * 0.8).normalized();
            let step = long * own.uniform(2, 0.6, 1.1) / parts as f32;
            let wide = own.uniform(3, 0.05, 0.11) * step + 0.006;
            for part in 0..parts as u64 {
                let weight = up(-hangs * 0.45) + current * 0.3 + direction(own, 10 + 2 * part) * 0.3;
                heading = (heading + weight).normalized();
                let end = above_ground(start + heading * step, 0.01);
                let leaf = Pose::pointing((start + end) * 0.5, end, own.uniform(40 + part, 0.0, 6.3));
                // A frond is widest in the middle.
                let along = (part as f32 + 0.7) / parts as f32;
                let broad = wide * (0.5 + 1.6 * along * (1.0 - along) * 2.0);
                let radii = vec3(broad, 0.15 * broad + 0.001, 0.62 * step);
                self.builder.put(Ellipsoid { radii }, leaf);
                start = end;
            }
        }
    }

    /// The current of this site: horizontal, length at most 1.
    pub(super) fn current(&self) -> Vec3 {
        let dice = self.builder.dice_for("current");
        let (sin, cos) = libm::sincosf(dice.uniform(0, 0.0, 6.3));
        vec3(cos, sin, 0.0) * dice.uniform(1, 0.2, 1.0)
    }

    fn grow_on(&mut self, spot: &GrowthSite, body: Skin, dice: Choices) {
        self.builder.growth_on(spot.host, body.finish(dice));
    }

    pub(super) fn begin(&mut self, body: Skin, category: Category, dice: Choices) {
        self.builder.object_of(body.finish(dice), category);
    }

    /// A tube that starts slightly early, so that bends have no gaps.
    pub(super) fn limb(&mut self, from: Vec3, to: Vec3, radius: f32) {
        let (begin, way) = (from, to - from);
        let length = way.length() + radius;
        let pose = Pose::pointing(begin, to, 0.0);
        self.builder.put(Tube { radius, length }, pose);
    }
}

pub(super) fn dice_number(dice: Choices, part: u64) -> usize {
    (1 << 20) + dice.key(900) as usize % (1 << 16) * 64 + part as usize
}
