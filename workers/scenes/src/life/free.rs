//! Ropes, fish, jellyfish and bubbles in open water.

use std::f32::consts::TAU;

use imaging::vector::{Vec3, vec3};

use super::body::Skin;
use super::growth::dice_number;
use super::{Colony, GrowthSite, above_ground};
use crate::categories::Category;
use crate::site::chance::Choices;
use crate::site::finish::{Material, SurfaceFinish};
use crate::site::pose::{Pose, horizontal, up};
use crate::site::solid::Ellipsoid;

/// Length of a rope that reaches no bottom, m.
const DROP_M: f32 = 14.0;
const LINKS: usize = 36;
const BACKS: [[f32; 3]; 4] = [
    [0.07, 0.085, 0.075],
    [0.12, 0.11, 0.09],
    [0.05, 0.065, 0.09],
    [0.14, 0.12, 0.07],
];
const BELLS: [[f32; 3]; 3] = [[0.5, 0.52, 0.55], [0.55, 0.45, 0.42], [0.42, 0.46, 0.55]];
const ROPES: [[f32; 3]; 4] = [
    [0.35, 0.3, 0.2],
    [0.06, 0.16, 0.2],
    [0.4, 0.16, 0.05],
    [0.12, 0.12, 0.11],
];

impl Colony {
    /// A rope that sags from a structure to another point, or to the bottom and along it.
    pub(super) fn rope(&mut self, dice: Choices, spots: &[GrowthSite]) {
        let near: Vec<&GrowthSite> = spots.iter().filter(|spot| spot.range < 5.0).collect();
        if near.is_empty() {
            return;
        }
        // It hangs from the highest of several candidates.
        let first = (0..6).map(|choice| pick_spot(&near, dice, choice)).fold(
            pick_spot(&near, dice, 0),
            |best, spot| {
                if spot.place.z > best.place.z { spot } else { best }
            },
        );
        let start = first.place + first.normal * 0.02;
        let away = horizontal(dice.uniform(8, 0.0, TAU)) * dice.uniform(9, 0.5, 2.0);
        let finish = if dice.chance(10, 0.5) {
            let spot = pick_spot(&near, dice, 11);
            spot.place + spot.normal * 0.02
        } else {
            vec3(start.x + away.x, start.y + away.y, (start.z - DROP_M).max(0.02))
        };
        let thick = dice.uniform(12, 0.006, 0.018);
        let mut color = Skin {
            color: dice.pick(13, &ROPES),
            gloss: 0.03,
            belly: 1.0,
        };
        color.color = color.color.map(|v| v * dice.uniform(14, 0.7, 1.1));
        self.begin(color, Category::Cable, dice);
        let sag = (finish - start).length() * dice.uniform(15, 0.08, 0.35);
        let drift = self.current() * (0.4 * sag) + first.normal * (0.7 * sag);
        let wave = dice.uniform(16, 0.01, 0.05);
        let node = |link: usize| {
            let t = link as f32 / LINKS as f32;
            let bow = 4.0 * t * (1.0 - t);
            let curl = horizontal(9.0 * t + dice.uniform(17, 0.0, TAU)) * (wave * bow);
            above_ground(
                start + (finish - start) * t + drift * bow + curl - up(sag * bow),
                thick,
            )
        };
        for link in 0..LINKS {
            self.limb(node(link), node(link + 1), thick);
        }
        // Its end rests on the bottom or hangs.
        let (mut end, mut heading) = (node(LINKS), horizontal(dice.uniform(18, 0.0, TAU)));
        for link in 0..10u64 {
            let turn = dice.uniform(20 + link, -0.5, 0.5);
            heading = (heading + horizontal(turn * 6.0) * 0.45).normalized();
            let next = above_ground(end + heading * 0.07 - up(0.05), thick);
            self.limb(end, next, thick);
            end = next;
        }
    }

    /// A fish with body, tail, fins and eyes. All fish of a site swim in roughly the same direction.
    pub(super) fn fish(&mut self, dice: Choices, place: Vec3) {
        let school = self.builder.dice_for("school");
        let color = school.pick(1, &BACKS).map(|v| v * dice.uniform(4, 0.8, 1.3));
        self.begin(
            Skin {
                color,
                gloss: 0.5,
                belly: 3.2,
            },
            Category::Fauna,
            dice,
        );
        let length = school.uniform(2, 0.05, 0.14) * dice.uniform(5, 0.7, 1.3);
        let yaw = school.uniform(3, 0.0, TAU) + dice.uniform(6, -0.7, 0.7);
        let ahead = (horizontal(yaw) + up(dice.uniform(7, -0.2, 0.2))).normalized();
        let side = up(1.0).cross(ahead).normalized();
        let over = ahead.cross(side);
        let bend = dice.uniform(8, -0.35, 0.35);
        let axes = [ahead, side, over];
        self.put_ellipsoid(length, [1.0, 0.17, 0.3], Pose { origin: place, axes });
        // The tail is bent aside, its two lobes up and down.
        let back = (ahead + side * bend).normalized();
        let aside = over.cross(back).normalized();
        let root = place - back * (0.95 * length);
        let pose = Pose {
            origin: root,
            axes: [back, aside, over],
        };
        self.put_ellipsoid(length, [0.28, 0.05, 0.1], pose);
        for lobe in [-1.0f32, 1.0] {
            let way = (over * lobe - back * 0.9).normalized();
            let center = root - back * (0.2 * length) + way * (0.17 * length);
            let pose = Pose {
                origin: center,
                axes: [way, aside, way.cross(aside)],
            };
            self.put_ellipsoid(length, [0.24, 0.02, 0.08], pose);
        }
        let fin = (over * 0.8 - ahead * 0.9).normalized();
        let pose = Pose {
            origin: place + over * (0.28 * length),
            axes: [fin, side, fin.cross(side)],
        };
        self.put_ellipsoid(length, [0.25, 0.015, 0.12], pose);
        self.begin(
            Skin {
                color: [0.02; 3],
                gloss: 1.0,
                belly: 1.0,
            },
            Category::Fauna,
            dice,
        );
        for eye in [-1.0f32, 1.0] {
            let center =
                place + ahead * (0.7 * length) + side * (eye * 0.1 * length) + over * (0.08 * length);
            self.put_ellipsoid(length, [0.05, 0.03, 0.05], Pose { origin: center, axes });
        }
    }

    fn put_ellipsoid(&mut self, length: f32, radii: [f32; 3], pose: Pose) {
        let radii = Vec3::from(radii) * length;
        self.builder.put(Ellipsoid { radii }, pose);
    }

    /// A jellyfish: bell, inner bell, arms and tentacles.
    pub(super) fn jellyfish(&mut self, dice: Choices, place: Vec3) {
        let color = dice.pick(4, &BELLS);
        self.begin(
            Skin {
                color,
                gloss: 0.3,
                belly: 0.6,
            },
            Category::Fauna,
            dice,
        );
        let radius = dice.uniform(5, 0.04, 0.11);
        let axis = (up(1.0) + horizontal(dice.uniform(6, 0.0, TAU)) * dice.uniform(7, 0.0, 0.7)).normalized();
        let pose = Pose::pointing(place, place + axis, 0.0);
        let open = dice.uniform(8, 0.45, 0.75);
        self.builder.put(
            Ellipsoid {
                radii: vec3(radius, radius, radius * open),
            },
            pose,
        );
        let rim = vec3(0.94 * radius, 0.94 * radius, 0.2 * radius);
        let lip = Pose {
            origin: place - axis * (0.32 * radius),
            ..pose
        };
        self.builder.put(Ellipsoid { radii: rim }, lip);
        for arm in 0..4u64 {
            let (sin, cos) = libm::sincosf(arm as f32 * TAU / 4.0);
            let out = pose.axes[0] * cos + pose.axes[1] * sin;
            let way = (out * 0.25 - axis).normalized();
            let center = place + out * (0.2 * radius) - axis * radius;
            let radii = vec3(0.09 * radius, 0.05 * radius, 0.8 * radius);
            self.builder
                .put(Ellipsoid { radii }, Pose::pointing(center, center + way, 0.4));
        }
        for tentacle in 0..12u64 {
            let own = dice.object(dice_number(dice, tentacle));
            let (sin, cos) = libm::sincosf(tentacle as f32 * TAU / 12.0);
            let out = pose.axes[0] * cos + pose.axes[1] * sin;
            let mut start = place + out * (0.85 * radius) - axis * (0.35 * radius);
            let step = radius * own.uniform(0, 0.3, 0.7);
            for part in 0..5u64 {
                let sway = horizontal(own.uniform(1, 0.0, TAU) + part as f32) * 0.35;
                let end = above_ground(start + (sway - axis + self.current() * 0.2) * step, 0.01);
                self.limb(start, end, 0.016 * radius + 0.0006);
                start = end;
            }
        }
    }

    /// A bubble: small ones are spheres, large ones are flattened (Clift, Grace and Weber 1978).
    pub(super) fn bubble(&mut self, dice: Choices, place: Vec3) {
        let share = dice.uniform(4, 0.0, 1.0);
        let radius = 0.0008 + 0.006 * share * share * share;
        let flat = 1.0 - 0.45 * share * share;
        self.builder
            .object_of(SurfaceFinish::new(Material::Bubble, dice), Category::Bubble);
        self.builder.ball(place, vec3(radius, radius, radius * flat), 0.0);
    }
}

fn pick_spot<'a>(spots: &[&'a GrowthSite], dice: Choices, choice: u64) -> &'a GrowthSite {
    spots[dice.count(choice, 0, spots.len() - 1)]
}
