//! The family `shaft`: flooded shafts and tunnels lined with concrete segments, cast rings or masonry, with mud on the
//! floor and ladders, pipes and cables on the walls.

use imaging::vector::{Vec3, vec3};

use crate::categories::Category;
use crate::site::Site;
use crate::site::builder::{Heights, SiteBuilder, SiteView};
use crate::site::chance::Choices;
use crate::site::finish::{Courses, JointPattern, Material, Unroll};
use crate::site::pose::{Pose, UP, ZERO, up};
use crate::site::solid::{Bore, Ring, Room, SolidBox};

/// Length of a tunnel or height of a shaft, m.
const LENGTH_M: f32 = 64.0;

/// Axes for objects fixed to a wall.
struct WallFrame {
    /// A point on the wall in view.
    foot: Vec3,
    /// Along the wall and the axis.
    along: Vec3,
    /// Away from the wall.
    out: Vec3,
}

impl WallFrame {
    /// A point at a distance along the wall and from it.
    fn point(&self, distance: f32, gap: f32) -> Vec3 {
        self.foot + self.along * distance + self.out * gap
    }
}

pub(crate) fn site(seed: u64, _: Option<f32>) -> Site {
    let dice = Choices::new(seed, "shaft");
    let mut builder = SiteBuilder::new(seed, "shaft");
    let view = match dice.count(0, 0, 2) {
        0 => tunnel(&mut builder, dice),
        1 => {
            let radius = dice.uniform(1, 1.5, 3.2);
            let pose = Pose::upright(up(-1.0), dice.uniform(2, 0.0, 6.3));
            bore(&mut builder, dice, radius, pose);
            shaft(&mut builder, dice, [radius, radius])
        }
        _ => {
            let half = [dice.uniform(1, 1.3, 2.6), dice.uniform(2, 1.3, 2.6)];
            builder.object(lining(dice, Unroll::Walls { half }, 1.6), Category::Lining);
            let middle = Pose::upright(up(LENGTH_M / 2.0 - 1.0), 0.0);
            let half_sides = vec3(half[0], half[1], LENGTH_M / 2.0);
            builder.put(Room { half: half_sides }, middle);
            shaft(&mut builder, dice, half)
        }
    };
    builder.site(&view)
}

/// The wall of a round tunnel or shaft.
fn bore(builder: &mut SiteBuilder, dice: Choices, radius: f32, pose: Pose) {
    let wall = Bore {
        radius,
        length: LENGTH_M,
    };
    builder.object(lining(dice, Unroll::Round { radius }, radius), Category::Lining);
    builder.put(wall, pose);
}

/// The lining: segments with bolt pockets, cast rings, or blocks in courses.
fn lining(dice: Choices, unroll: Unroll, radius: f32) -> Material {
    let around = std::f32::consts::TAU * radius;
    let (height, length, joint, pocket, variety) = match dice.count(10, 0, 2) {
        0 => {
            let pieces = dice.count(11, 5, 8) as f32;
            (dice.uniform(12, 1.0, 1.5), around / pieces, 0.011, 1.0, 0.07)
        }
        1 => (dice.uniform(12, 1.8, 3.0), around / 2.0, 0.008, 0.0, 0.05),
        _ => {
            let height = dice.uniform(12, 0.2, 0.42);
            let pieces = (around / (height * dice.uniform(13, 1.6, 2.4))).round();
            (height, around / pieces, 0.009, 0.0, 0.2)
        }
    };
    Material::Concrete(JointPattern::Courses(Courses {
        unroll,
        height,
        length,
        joint,
        pocket,
        variety,
    }))
}

/// A level tunnel along y with silt on its floor.
fn tunnel(builder: &mut SiteBuilder, dice: Choices) -> SiteView {
    let radius = dice.uniform(1, 1.2, 2.4);
    let center = radius * dice.uniform(2, 0.6, 0.9);
    let (start, end) = (vec3(0.0, -4.0, center), vec3(0.0, LENGTH_M - 4.0, center));
    let pose = Pose::pointing(start, end, dice.uniform(3, 0.0, 6.3));
    bore(builder, dice, radius, pose);
    let along = vec3(0.0, 1.0, 0.0);
    let mut sides = [-1.0, 1.0];
    if dice.chance(4, 0.5) {
        sides.reverse();
    }
    for (i, side) in sides.into_iter().take(dice.count(5, 1, 2)).enumerate() {
        let lift = dice.uniform(20 + i as u64, 0.1, 0.8);
        let (sin, cos) = libm::sincosf(lift);
        let outward = vec3(side * cos, 0.0, sin);
        let wall = WallFrame {
            foot: up(center) + outward * radius,
            along,
            out: -outward,
        };
        run(builder, dice.object(1 + i), &wall, [-1.5, 12.0]);
    }
    let middle = vec3(0.0, 4.0, 0.0);
    builder.stones(dice.count(6, 2, 8), middle, [0.5 * radius, 3.6], [0.04, 0.22]);
    builder.debris(dice.count(7, 0, 3), middle, [0.4 * radius, 3.0]);
    let ground = builder.dice_for("ground");
    let (x, y) = (ground.uniform(0, -0.6, 0.6) * radius, ground.uniform(1, 2.0, 7.0));
    builder.mound(vec3(x, y, 0.0), 1.2, 0.13);
    let eye_x = dice.uniform(30, -0.3, 0.3) * radius;
    let (x, y) = (dice.uniform(32, -0.75, 0.75) * radius, dice.uniform(33, 1.5, 4.5));
    let eye_height = (center + dice.uniform(31, -0.25, 0.25) * radius).max(0.45);
    let target_height = (center + dice.uniform(34, -0.5, 0.5) * radius).max(0.1);
    SiteView {
        eye: vec3(eye_x, 0.0, eye_height),
        target: vec3(x, y, target_height),
        travel: along * 5.0,
        roll: dice.uniform(35, -0.1, 0.1),
        lamp_m: dice.uniform(36, 1.9, 3.0),
        ambient: dice.uniform(37, 0.005, 0.05),
        floor: 0.0,
        heights: Heights::Camera([eye_height; 2]),
        stretch: [1.0; 2],
        turn_deg: 10.0,
        least_structure: 0.08,
    }
}

/// Furniture of an upright shaft of the given half widths, and a camera in it.
fn shaft(builder: &mut SiteBuilder, dice: Choices, half: [f32; 2]) -> SiteView {
    let height = dice.uniform(30, 1.4, 6.0);
    // The far wall is in view: the camera looks along +y.
    let offset = dice.uniform(20, -0.3, 0.3) * half[0];
    let out = vec3(0.0, -1.0, 0.0);
    if dice.chance(21, 0.7) {
        let foot = vec3(offset, wall_depth(half, offset.abs() + 0.24), -0.3) + out * 0.2;
        builder.ladder(foot, UP, vec3(0.24, 0.0, 0.0), 42);
        for stay in 0..6 {
            for side in [-0.24, 0.24] {
                let end = foot + vec3(side, 0.0, 0.9 + 2.1 * stay as f32);
                builder.tube(end, end - out * 0.3, 0.018);
            }
        }
    }
    let side = if offset > 0.0 { -1.0 } else { 1.0 };
    for i in 0..dice.count(22, 1, 2) {
        let x = side * half[0] * (0.32 + 0.3 * i as f32) + offset * 0.3;
        let wall = WallFrame {
            foot: vec3(x, wall_depth(half, x), height),
            along: UP,
            out,
        };
        run(builder, dice.object(1 + i), &wall, [-height - 0.3, 9.0]);
    }
    builder.stones(dice.count(23, 2, 7), ZERO, half.map(|h| 0.6 * h), [0.05, 0.25]);
    builder.debris(dice.count(24, 1, 4), vec3(0.0, 0.2, 0.0), half.map(|h| 0.45 * h));
    let x = dice.uniform(31, -0.25, 0.25) * half[0];
    let y = dice.uniform(32, -0.6, 0.0) * half[1];
    // Level at the wall, slanted, or steeply down.
    let drop = dice.pick(33, &[0.0, 0.3, 0.9, 2.4]) + dice.uniform(34, -0.3, 0.3);
    let far = half[1] * 0.9;
    let target_x = dice.uniform(35, -0.5, 0.5) * half[0];
    SiteView {
        eye: vec3(x, y, height),
        target: vec3(target_x, far, height - drop * (far - y)),
        travel: UP * -(height - 0.8),
        roll: dice.uniform(36, -0.12, 0.12),
        lamp_m: dice.uniform(37, 1.7, 2.8),
        ambient: dice.uniform(38, 0.005, 0.06),
        floor: 0.0,
        heights: Heights::Camera([height; 2]),
        stretch: [1.0; 2],
        turn_deg: 10.0,
        least_structure: 0.08,
    }
}

/// A pipe, cables or a tray on brackets along a wall, between two distances along it.
fn run(builder: &mut SiteBuilder, dice: Choices, wall: &WallFrame, [from, to]: [f32; 2]) {
    let WallFrame { foot, along, out } = *wall;
    let across = along.cross(out);
    let gap = dice.uniform(0, 0.12, 0.22);
    let axes = [across, along.cross(across), along];
    match dice.count(1, 0, 2) {
        0 => {
            let radius = dice.uniform(2, 0.05, 0.11);
            builder.object(Material::Steel, Category::Pipe);
            builder.tube(wall.point(from, gap), wall.point(to, gap), radius);
            builder.object(Material::Steel, Category::Fitting);
            let flange = dice.uniform(3, 0.4, 3.4);
            let [start, end] = [flange - 0.03, flange + 0.03].map(|distance| wall.point(distance, gap));
            builder.tube(start, end, radius * 1.7);
        }
        1 => {
            for cable in 0..dice.count(2, 2, 4) {
                builder.object(Material::Rubber, Category::Cable);
                let side = across * (0.06 * cable as f32 - 0.09);
                let [start, end] = [from, to].map(|distance| wall.point(distance, gap) + side);
                builder.tube(start, end, 0.018);
            }
        }
        _ => {
            builder.object(Material::Steel, Category::Beam);
            let origin = wall.point((from + to) / 2.0, gap);
            let half = vec3(dice.uniform(2, 0.1, 0.2), 0.012, (to - from) / 2.0);
            builder.put(SolidBox { half }, Pose { origin, axes });
        }
    }
    let spacing = dice.uniform(4, 0.9, 1.6);
    let count = ((to - from) / spacing) as usize;
    for i in 0..count {
        let place = from + spacing * (i as f32 + 0.5);
        // Some brackets are lost.
        if dice.chance(40 + i as u64, 0.12) {
            continue;
        }
        bracket(builder, foot + along * place, axes, out, gap);
    }
    if dice.chance(5, 0.35) {
        // A loose cable hangs in a bow.
        builder.object(Material::Rubber, Category::Cable);
        let bow = Ring::new(dice.uniform(6, 0.25, 0.5), 0.016, 1.7);
        let center = wall.point(dice.uniform(7, 0.2, 2.0), gap) + out * 0.05;
        builder.ring(bow, center, across, out + UP * -0.6);
    }
}

/// A plate on the wall with an arm and two bolts.
fn bracket(builder: &mut SiteBuilder, place: Vec3, axes: [Vec3; 3], out: Vec3, gap: f32) {
    builder.object(Material::Steel, Category::Bracket);
    let plate = (0.01, vec3(0.11, 0.02, 0.07));
    let arm = (gap / 2.0, vec3(0.03, gap / 2.0 + 0.04, 0.012));
    for (away, half) in [plate, arm] {
        let origin = place + out * away;
        builder.put(SolidBox { half }, Pose { origin, axes });
    }
    for side in [-0.08, 0.08] {
        let bolt = place + axes[0] * side;
        builder.tube(bolt, bolt + out * 0.055, 0.014);
    }
}

/// Distance of the wall from the axis at a horizontal offset; equal half widths mean a round shaft.
fn wall_depth(half: [f32; 2], offset: f32) -> f32 {
    if half[0] == half[1] {
        (half[1] * half[1] - offset * offset).sqrt()
    } else {
        half[1]
    }
}
