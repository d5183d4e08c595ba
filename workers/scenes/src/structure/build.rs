//! The six kinds of site.

use crate::categories::Category;
use crate::site::builder::Builder;
use crate::site::finish::{Material, Pattern};
use crate::site::solid::{Ball, Ring, Shape};
use crate::site::vector::{Pose, Vec3, vec3};

/// Where to look, and from how far away, in metres.
type View = (Vec3, f32);

impl Builder {
    fn metal_or_concrete(&self, choice: u64) -> Material {
        self.dice.pick(
            choice,
            &[
                Material::Steel,
                Material::Steel,
                Material::Concrete(Pattern::Boards),
            ],
        )
    }

    /// An upright pile with collars.
    fn pile(&mut self, foot: Vec3, radius: f32, material: Material, collars: usize) {
        self.object(material, Category::Pile);
        self.tube(foot - vec3(0.0, 0.0, 0.5), foot + vec3(0.0, 0.0, 14.0), radius);
        self.bank(foot, radius);
        for collar in 0..collars {
            let z = 0.7 + 1.6 * collar as f32 + self.dice.between(900 + collar as u64, 0.0, 0.8);
            self.tube(
                foot + vec3(0.0, 0.0, z),
                foot + vec3(0.0, 0.0, z + 0.12),
                radius * 1.13,
            );
        }
    }

    /// Sand that the current has heaped against a foot, more on one side.
    fn bank(&mut self, foot: Vec3, radius: f32) {
        let dice = self.about("bank").object((foot.x * 64.0) as i32 as usize);
        let lee =
            Vec3::horizontal(self.about("bank").between(9, 0.0, 6.3)) * (radius * dice.between(0, 0.2, 0.7));
        let wide = radius * dice.between(1, 1.9, 2.6) + 0.2;
        self.mound(
            foot.x + lee.x,
            foot.y + lee.y,
            wide,
            wide * dice.between(2, 0.1, 0.24),
        );
    }

    /// A clamp with a sacrificial anode on a pile.
    fn anode(&mut self, foot: Vec3, radius: f32, azimuth: f32, z: f32) {
        self.object(Material::Anode, Category::Anode);
        let out = Vec3::horizontal(azimuth);
        let centre = foot + out * (radius + 0.11) + vec3(0.0, 0.0, z);
        self.block(centre, vec3(0.07, 0.09, 0.38), azimuth);
        for end in [-0.3, 0.3] {
            self.tube(
                foot + out * (radius * 0.6) + vec3(0.0, 0.0, z + end),
                centre + vec3(0.0, 0.0, end),
                0.022,
            );
        }
    }

    pub(super) fn single_pile(&mut self) -> View {
        let radius = self.dice.between(0, 0.35, 0.75);
        let material = self.metal_or_concrete(1);
        self.pile(vec3(0.0, 0.0, 0.0), radius, material, self.dice.count(2, 0, 3));
        for i in 0..self.dice.count(3, 1, 3) {
            let azimuth = -1.6 + self.dice.between(10 + i as u64, -0.9, 0.9);
            self.anode(vec3(0.0, 0.0, 0.0), radius, azimuth, 0.9 + 1.1 * i as f32);
        }
        if self.dice.chance(4, 0.6) {
            self.object(Material::Concrete(Pattern::Boards), Category::Support);
            let half = vec3(radius * 2.2, radius * 2.2, self.dice.between(5, 0.15, 0.4));
            self.block(vec3(0.0, 0.0, half.z), half, self.dice.between(6, 0.0, 1.5));
        }
        (vec3(0.0, 0.0, self.dice.between(7, 1.2, 2.2)), radius * 3.0 + 1.4)
    }

    pub(super) fn pile_row(&mut self) -> View {
        let radius = self.dice.between(0, 0.22, 0.45);
        let spacing = self.dice.between(1, 1.6, 2.8);
        let material = self.metal_or_concrete(2);
        let count = self.dice.count(3, 4, 7);
        let slant = self.dice.between(4, -0.5, 0.9);
        let direction = vec3(libm::cosf(slant), libm::sinf(slant), 0.0);
        let foot = |i: usize| direction * ((i as f32 - 1.2) * spacing);
        for i in 0..count {
            self.pile(foot(i), radius, material, self.dice.count(20 + i as u64, 0, 1));
        }
        self.object(self.metal_or_concrete(5), Category::Beam);
        let height = self.dice.between(6, 1.6, 3.0);
        let middle = (foot(0) + foot(count - 1)) * 0.5 + vec3(0.0, -radius, height);
        let half = vec3(
            (foot(count - 1) - foot(0)).length() / 2.0 + 0.5,
            0.16,
            self.dice.between(7, 0.16, 0.32),
        );
        self.block(middle, half, slant);
        if self.dice.chance(8, 0.6) {
            self.object(Material::Steel, Category::Brace);
            self.tube(
                foot(0) + vec3(0.0, 0.0, 0.4),
                foot(1) + vec3(0.0, 0.0, height - 0.2),
                0.09,
            );
        }
        (vec3(0.0, 0.0, 1.4), 3.4)
    }

    pub(super) fn braced_legs(&mut self) -> View {
        let half = self.dice.between(0, 1.1, 1.8);
        let leg = self.dice.between(1, 0.16, 0.28);
        let height = 9.0;
        let corner = |i: usize, z: f32| {
            let (x, y) = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)][i % 4];
            let reach = half * (1.0 - 0.035 * z);
            vec3(x * reach, y * reach, z)
        };
        let material = if self.dice.chance(2, 0.8) {
            Material::Steel
        } else {
            Material::Growth
        };
        for i in 0..4 {
            self.object(material, Category::Pile);
            self.tube(corner(i, -0.4), corner(i, height), leg);
            self.tube(corner(i, 0.0), corner(i, 0.35), leg * 1.8);
            self.bank(corner(i, 0.0), leg * 1.8);
        }
        let level = self.dice.between(3, 1.9, 2.6);
        self.object(material, Category::Brace);
        for storey in 0..3 {
            let (low, high) = (0.5 + level * storey as f32, 0.5 + level * (storey + 1) as f32);
            for i in 0..4 {
                self.tube(corner(i, high), corner(i + 1, high), leg * 0.6);
                let (a, b) = if (i + storey) % 2 == 0 {
                    (i, i + 1)
                } else {
                    (i + 1, i)
                };
                self.tube(corner(a, low), corner(b, high), leg * 0.5);
                self.put(
                    Shape::Ball(Ball {
                        radii: vec3(1.0, 1.0, 1.0) * (leg * 1.25),
                    }),
                    Pose::upright(corner(i, high), 0.0),
                );
            }
        }
        let z = self.dice.between(4, 0.9, 2.0);
        self.anode(corner(0, 0.0), leg, -1.4, z);
        (vec3(-0.5, -half, self.dice.between(5, 1.2, 2.2)), 2.6)
    }

    pub(super) fn pipeline(&mut self) -> View {
        let radius = self.dice.between(0, 0.2, 0.46);
        let height = radius + self.dice.between(1, 0.12, 0.5);
        let material = self.dice.pick(
            2,
            &[
                Material::Steel,
                Material::Concrete(Pattern::Boards),
                Material::Steel,
            ],
        );
        let yaw = self.dice.between(3, -0.45, 0.45);
        let along = Vec3::horizontal(yaw);
        let at = |t: f32| along * t + vec3(0.0, 0.0, height);
        self.object(material, Category::Pipe);
        self.tube(at(-9.0), at(9.0), radius);
        let flange = self.dice.between(4, -0.8, 0.8);
        self.flange(at(flange), along, radius);
        for i in 0..4 {
            self.object(Material::Concrete(Pattern::Boards), Category::Support);
            let place = along * (-4.2 + 2.7 * i as f32 + self.dice.between(20 + i, -0.3, 0.3));
            let half = vec3(0.2, radius * 2.1, (height - radius) / 2.0 + 0.06);
            self.block(place + vec3(0.0, 0.0, half.z), half, yaw);
        }
        if self.dice.chance(5, 0.6) {
            self.object(Material::Steel, Category::Fitting);
            let foot = at(self.dice.between(6, 0.9, 1.8));
            self.tube(foot, foot + vec3(0.0, 0.0, 2.6), radius * 0.45);
            self.tube(
                foot + vec3(0.0, 0.0, 0.9),
                foot + vec3(0.0, 0.0, 1.05),
                radius * 0.75,
            );
            let wheel = Pose::along(
                foot + vec3(0.0, -radius * 0.9, 0.98),
                foot + vec3(0.0, -2.0, 0.98),
                0.0,
            );
            self.put(Shape::Ring(Ring::new(0.2, 0.025, std::f32::consts::PI)), wheel);
        }
        (vec3(0.0, 0.0, height * 0.9), radius * 3.0 + 1.3)
    }

    pub(super) fn plate_wall(&mut self) -> View {
        let wide = self.dice.between(0, 0.32, 0.6);
        let yaw = self.dice.between(1, -0.35, 0.35);
        let (along, out) = (
            Vec3::horizontal(yaw),
            Vec3::horizontal(yaw - std::f32::consts::FRAC_PI_2),
        );
        let material = if self.dice.chance(2, 0.7) {
            Material::Steel
        } else {
            Material::Concrete(Pattern::Boards)
        };
        self.object(material, Category::Plate);
        for i in 0..24 {
            let depth = if i % 2 == 0 { 0.0 } else { wide * 0.55 };
            let centre = along * ((i as f32 - 11.5) * wide * 1.02) + out * depth + vec3(0.0, 0.0, 3.5);
            self.block(centre, vec3(wide / 2.0, 0.09, 4.0), yaw);
        }
        self.object(Material::Steel, Category::Beam);
        let z = self.dice.between(3, 1.2, 2.2);
        let front = out * (wide * 0.55 + 0.25);
        self.block(front + vec3(0.0, 0.0, z), vec3(13.0, 0.13, 0.16), yaw);
        if self.dice.chance(4, 0.7) {
            let foot = front + along * self.dice.between(5, -1.2, 1.2) + out * 0.25;
            self.ladder(foot, vec3(0.0, 0.0, 1.0), along * 0.24, 20);
        }
        self.object(Material::Steel, Category::Plate);
        let plate = front + along * self.dice.between(6, -1.8, 1.8) + vec3(0.0, 0.0, z + 0.75);
        self.block(plate, vec3(0.42, 0.04, 0.32), yaw);
        for (u, v) in [
            (-0.34, -0.24),
            (0.34, -0.24),
            (-0.34, 0.24),
            (0.34, 0.24),
            (0.0, 0.24),
            (0.0, -0.24),
        ] {
            let at = plate + along * u + vec3(0.0, 0.0, v);
            self.tube(at, at + out * 0.085, 0.032);
        }
        (front + vec3(0.0, 0.0, self.dice.between(7, 0.9, 1.8)), 2.4)
    }

    pub(super) fn frame_of_beams(&mut self) -> View {
        let yaw = self.dice.between(0, -0.8, 0.8);
        let along = Vec3::horizontal(yaw);
        let across = Vec3::horizontal(yaw + std::f32::consts::FRAC_PI_2);
        let span = self.dice.between(1, 1.5, 2.2);
        for (i, side) in [-1.0f32, 1.0].into_iter().enumerate() {
            for (j, depth) in [-0.7f32, 0.9].into_iter().enumerate() {
                self.object(Material::Steel, Category::Beam);
                let foot = along * (side * span) + across * depth;
                self.upright_beam(
                    foot,
                    0.17,
                    self.dice.between(10 + 2 * i as u64 + j as u64, 3.0, 5.0),
                    yaw,
                );
            }
        }
        let z = self.dice.between(2, 1.5, 2.3);
        for depth in [-0.7, 0.9] {
            self.object(self.metal_or_concrete(3), Category::Beam);
            self.block(
                across * depth + vec3(0.0, 0.0, z),
                vec3(span + 0.4, 0.12, 0.15),
                yaw,
            );
        }
        self.object(Material::Steel, Category::Pipe);
        self.tube(
            along * -3.5 + across * -1.1 + vec3(0.0, 0.0, 0.5),
            along * 3.5 + across * -1.0 + vec3(0.0, 0.0, 0.75),
            0.13,
        );
        self.object(Material::Steel, Category::Plate);
        self.block(
            across * -0.86 + vec3(0.0, 0.0, z - 0.55),
            vec3(0.5, 0.03, 0.4),
            yaw,
        );
        self.object(Material::Growth, Category::Pile);
        self.tube(
            along * 0.6 + across * 0.2 - vec3(0.0, 0.0, 0.3),
            along * 0.9 + across * 0.3 + vec3(0.0, 0.0, 6.0),
            self.dice.between(4, 0.18, 0.34),
        );
        (vec3(0.0, -0.5, z * 0.7), 2.8)
    }

    /// An I-beam on end: two flanges and a web.
    fn upright_beam(&mut self, foot: Vec3, half: f32, height: f32, yaw: f32) {
        let centre = foot + vec3(0.0, 0.0, height / 2.0 - 0.2);
        let out = Vec3::horizontal(yaw + std::f32::consts::FRAC_PI_2);
        for side in [-half, half] {
            self.block(centre + out * side, vec3(half * 0.85, 0.022, height / 2.0), yaw);
        }
        self.block(centre, vec3(0.02, half, height / 2.0), yaw);
    }
}
