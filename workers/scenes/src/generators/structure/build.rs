//! The six kinds of site.

use std::f32::consts::{FRAC_PI_2, PI};

use imaging::vector::{Vec3, vec3};

use crate::categories::Category;
use crate::site::builder::SiteBuilder;
use crate::site::finish::{JointPattern, Material};
use crate::site::pose::{Pose, UP, ZERO, horizontal, up};
use crate::site::solid::Ring;

/// Target of the camera and its distance, m.
pub(super) struct ViewTarget {
    pub(super) target: Vec3,
    pub(super) distance: f32,
    /// Height of the top of the structure.
    pub(super) top: f32,
}

impl ViewTarget {
    fn new(target: Vec3, distance: f32, top: f32) -> Self {
        Self {
            target,
            distance,
            top,
        }
    }
}

const BOARDS: Material = Material::Concrete(JointPattern::Boards);

impl SiteBuilder {
    fn metal_or_concrete(&self, choice: u64) -> Material {
        let options = [Material::Steel, Material::Steel, BOARDS];
        self.dice.pick(choice, &options)
    }

    fn pile(&mut self, foot: Vec3, radius: f32, material: Material, collars: usize) {
        self.object(material, Category::Pile);
        self.tube(foot - up(0.5), foot + up(14.0), radius);
        self.bank(foot, radius);
        for collar in 0..collars {
            let z = 0.7 + 1.6 * collar as f32 + self.dice.uniform(900 + collar as u64, 0.0, 0.8);
            self.tube(foot + up(z), foot + up(z + 0.12), radius * 1.13);
        }
    }

    /// Sand heaped against a foot by the current, more on one side.
    fn bank(&mut self, foot: Vec3, radius: f32) {
        let bank = self.dice_for("bank");
        let dice = bank.object((foot.x * 64.0) as i32 as usize);
        let lee = horizontal(bank.uniform(9, 0.0, 6.3)) * (radius * dice.uniform(0, 0.2, 0.7));
        let wide = radius * dice.uniform(1, 1.9, 2.6) + 0.2;
        self.mound(foot + lee, wide, wide * dice.uniform(2, 0.1, 0.24));
    }

    /// A clamp with a sacrificial anode on a pile.
    fn anode(&mut self, foot: Vec3, radius: f32, azimuth: f32, z: f32) {
        self.object(Material::Anode, Category::Anode);
        let out = horizontal(azimuth);
        let center = foot + out * (radius + 0.11) + up(z);
        self.block(center, vec3(0.07, 0.09, 0.38), azimuth);
        for end in [-0.3, 0.3] {
            let clamp = foot + out * (radius * 0.6) + up(z + end);
            self.tube(clamp, center + up(end), 0.022);
        }
    }

    pub(super) fn single_pile(&mut self) -> ViewTarget {
        let dice = self.dice;
        let radius = dice.uniform(0, 0.35, 0.75);
        let material = self.metal_or_concrete(1);
        self.pile(ZERO, radius, material, dice.count(2, 0, 3));
        for i in 0..dice.count(3, 1, 3) {
            let azimuth = -1.6 + dice.uniform(10 + i as u64, -0.9, 0.9);
            self.anode(ZERO, radius, azimuth, 0.9 + 1.1 * i as f32);
        }
        if dice.chance(4, 0.6) {
            self.object(BOARDS, Category::Support);
            let half = vec3(radius * 2.2, radius * 2.2, dice.uniform(5, 0.15, 0.4));
            self.block(up(half.z), half, dice.uniform(6, 0.0, 1.5));
        }
        ViewTarget::new(up(dice.uniform(7, 1.2, 2.2)), radius * 3.0 + 1.4, 14.0)
    }

    pub(super) fn pile_row(&mut self) -> ViewTarget {
        let dice = self.dice;
        let radius = dice.uniform(0, 0.22, 0.45);
        let spacing = dice.uniform(1, 1.6, 2.8);
        let material = self.metal_or_concrete(2);
        let count = dice.count(3, 4, 7);
        let slant = dice.uniform(4, -0.5, 0.9);
        let direction = vec3(libm::cosf(slant), libm::sinf(slant), 0.0);
        let foot = |i: usize| direction * ((i as f32 - 1.2) * spacing);
        for i in 0..count {
            self.pile(foot(i), radius, material, dice.count(20 + i as u64, 0, 1));
        }
        self.object(self.metal_or_concrete(5), Category::Beam);
        let height = dice.uniform(6, 1.6, 3.0);
        let (first, last) = (foot(0), foot(count - 1));
        let middle = (first + last) * 0.5 + vec3(0.0, -radius, height);
        let length = (last - first).length() / 2.0 + 0.5;
        self.block(middle, vec3(length, 0.16, dice.uniform(7, 0.16, 0.32)), slant);
        if dice.chance(8, 0.6) {
            self.object(Material::Steel, Category::Brace);
            self.tube(first + up(0.4), foot(1) + up(height - 0.2), 0.09);
        }
        ViewTarget::new(up(1.4), 3.4, 14.0)
    }

    pub(super) fn braced_legs(&mut self) -> ViewTarget {
        let dice = self.dice;
        let half = dice.uniform(0, 1.1, 1.8);
        let leg = dice.uniform(1, 0.16, 0.28);
        let height = 9.0;
        let corner = |i: usize, z: f32| {
            let (x, y) = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)][i % 4];
            let reach = half * (1.0 - 0.035 * z);
            vec3(x * reach, y * reach, z)
        };
        let steel = dice.chance(2, 0.8);
        let material = if steel { Material::Steel } else { Material::Growth };
        for i in 0..4 {
            self.object(material, Category::Pile);
            self.tube(corner(i, -0.4), corner(i, height), leg);
            self.tube(corner(i, 0.0), corner(i, 0.35), leg * 1.8);
            self.bank(corner(i, 0.0), leg * 1.8);
        }
        let level = dice.uniform(3, 1.9, 2.6);
        self.object(material, Category::Brace);
        let knot = vec3(1.0, 1.0, 1.0) * (leg * 1.25);
        for storey in 0..3 {
            let (low, high) = (0.5 + level * storey as f32, 0.5 + level * (storey + 1) as f32);
            for i in 0..4 {
                self.tube(corner(i, high), corner(i + 1, high), leg * 0.6);
                let even = (i + storey) % 2 == 0;
                let (a, b) = if even { (i, i + 1) } else { (i + 1, i) };
                self.tube(corner(a, low), corner(b, high), leg * 0.5);
                self.ball(corner(i, high), knot, 0.0);
            }
        }
        let z = dice.uniform(4, 0.9, 2.0);
        self.anode(corner(0, 0.0), leg, -1.4, z);
        ViewTarget::new(vec3(-0.5, -half, dice.uniform(5, 1.2, 2.2)), 2.6, height)
    }

    pub(super) fn pipeline(&mut self, burial: Option<f32>) -> ViewTarget {
        let dice = self.dice;
        let radius = dice.uniform(0, 0.2, 0.46);
        let height = match burial {
            Some(share) => radius - 2.0 * radius * share,
            None => radius + dice.uniform(1, 0.12, 0.5),
        };
        let material = dice.pick(2, &[Material::Steel, BOARDS, Material::Steel]);
        let yaw = dice.uniform(3, -0.45, 0.45);
        let along = horizontal(yaw);
        let axis = |t: f32| along * t + up(height);
        self.object(material, Category::Pipe);
        self.tube(axis(-9.0), axis(9.0), radius);
        let flange = dice.uniform(4, -0.8, 0.8);
        self.flange(axis(flange), along, radius);
        // A pipe on the ground needs no supports.
        for i in 0..if burial.is_some() { 0 } else { 4 } {
            self.object(BOARDS, Category::Support);
            let place = along * (-4.2 + 2.7 * i as f32 + dice.uniform(20 + i, -0.3, 0.3));
            let half = vec3(0.2, radius * 2.1, (height - radius) / 2.0 + 0.06);
            self.block(place + up(half.z), half, yaw);
        }
        if dice.chance(5, 0.6) {
            self.object(Material::Steel, Category::Fitting);
            let foot = axis(dice.uniform(6, 0.9, 1.8));
            self.tube(foot, foot + up(2.6), radius * 0.45);
            self.tube(foot + up(0.9), foot + up(1.05), radius * 0.75);
            let hub = foot + vec3(0.0, -radius * 0.9, 0.98);
            let wheel = Pose::pointing(hub, foot + vec3(0.0, -2.0, 0.98), 0.0);
            self.put(Ring::new(0.2, 0.025, PI), wheel);
        }
        ViewTarget::new(up(height * 0.9), radius * 3.0 + 1.3, 2.6)
    }

    pub(super) fn plate_wall(&mut self) -> ViewTarget {
        let dice = self.dice;
        let wide = dice.uniform(0, 0.32, 0.6);
        let yaw = dice.uniform(1, -0.35, 0.35);
        let (along, out) = (horizontal(yaw), horizontal(yaw - FRAC_PI_2));
        let steel = dice.chance(2, 0.7);
        self.object(if steel { Material::Steel } else { BOARDS }, Category::Plate);
        for i in 0..24 {
            let depth = if i % 2 == 0 { 0.0 } else { wide * 0.55 };
            let center = along * ((i as f32 - 11.5) * wide * 1.02) + out * depth + up(3.5);
            self.block(center, vec3(wide / 2.0, 0.09, 4.0), yaw);
        }
        self.object(Material::Steel, Category::Beam);
        let z = dice.uniform(3, 1.2, 2.2);
        let front = out * (wide * 0.55 + 0.25);
        self.block(front + up(z), vec3(13.0, 0.13, 0.16), yaw);
        if dice.chance(4, 0.7) {
            let foot = front + along * dice.uniform(5, -1.2, 1.2) + out * 0.25;
            self.ladder(foot, UP, along * 0.24, 20);
        }
        self.object(Material::Steel, Category::Plate);
        let plate = front + along * dice.uniform(6, -1.8, 1.8) + up(z + 0.75);
        self.block(plate, vec3(0.42, 0.04, 0.32), yaw);
        let (left, middle, right, bottom, top) = (-0.34, 0.0, 0.34, -0.24, 0.24);
        let corners = [(left, bottom), (right, bottom), (left, top), (right, top)];
        for (u, v) in corners.into_iter().chain([(middle, top), (middle, bottom)]) {
            let bolt = plate + along * u + up(v);
            self.tube(bolt, bolt + out * 0.085, 0.032);
        }
        ViewTarget::new(front + up(dice.uniform(7, 0.9, 1.8)), 2.4, 7.5)
    }

    pub(super) fn frame_of_beams(&mut self) -> ViewTarget {
        let dice = self.dice;
        let yaw = dice.uniform(0, -0.8, 0.8);
        let (along, across) = (horizontal(yaw), horizontal(yaw + FRAC_PI_2));
        let span = dice.uniform(1, 1.5, 2.2);
        let feet = [(-1.0, -0.7), (-1.0, 0.9), (1.0, -0.7), (1.0, 0.9)];
        for (i, (side, depth)) in feet.into_iter().enumerate() {
            self.object(Material::Steel, Category::Beam);
            let foot = along * (side * span) + across * depth;
            self.upright_beam(foot, 0.17, dice.uniform(10 + i as u64, 3.0, 5.0), yaw);
        }
        let z = dice.uniform(2, 1.5, 2.3);
        for depth in [-0.7, 0.9] {
            self.object(self.metal_or_concrete(3), Category::Beam);
            self.block(across * depth + up(z), vec3(span + 0.4, 0.12, 0.15), yaw);
        }
        self.object(Material::Steel, Category::Pipe);
        let start = along * -3.5 + across * -1.1 + up(0.5);
        self.tube(start, along * 3.5 + across * -1.0 + up(0.75), 0.13);
        self.object(Material::Steel, Category::Plate);
        self.block(across * -0.86 + up(z - 0.55), vec3(0.5, 0.03, 0.4), yaw);
        self.object(Material::Growth, Category::Pile);
        let foot = along * 0.6 + across * 0.2 - up(0.3);
        let head = along * 0.9 + across * 0.3 + up(6.0);
        self.tube(foot, head, dice.uniform(4, 0.18, 0.34));
        ViewTarget::new(vec3(0.0, -0.5, z * 0.7), 2.8, 4.0)
    }

    /// An upright I-beam: two flanges and a web.
    fn upright_beam(&mut self, foot: Vec3, half: f32, height: f32, yaw: f32) {
        let center = foot + up(height / 2.0 - 0.2);
        let out = horizontal(yaw + FRAC_PI_2);
        for side in [-half, half] {
            self.block(center + out * side, vec3(half * 0.85, 0.022, height / 2.0), yaw);
        }
        self.block(center, vec3(0.02, half, height / 2.0), yaw);
    }
}
