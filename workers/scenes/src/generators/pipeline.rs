//! The family `pipeline`: a coated pipe on blocks, saddles, trestles or the bare seabed, with field joints, weld seams,
//! anodes and damage, as seen by a survey vehicle.

use std::f32::consts::FRAC_PI_2;

use imaging::vector::{Vec3, vec3};

use crate::categories::Category;
use crate::site::Site;
use crate::site::builder::{Heights, SiteBuilder, SiteView};
use crate::site::chance::Choices;
use crate::site::finish::{Coat, JointPattern, Material};
use crate::site::pose::{UP, horizontal, up};

const HALF_M: f32 = 26.0;
/// Height of a course of bags, m.
const COURSE_M: f32 = 0.15;
/// Colors of field-joint bands: heat-shrink sleeves, tape, mastic, primed steel.
const BANDS: [[f32; 3]; 4] = [
    [0.04, 0.04, 0.043],
    [0.17, 0.10, 0.05],
    [0.30, 0.16, 0.06],
    [0.33, 0.33, 0.32],
];

struct Pipe {
    radius: f32,
    /// Height of its axis.
    height: f32,
    yaw: f32,
    along: Vec3,
    across: Vec3,
}

impl Pipe {
    fn axis(&self, distance: f32) -> Vec3 {
        self.along * distance + up(self.height)
    }

    /// A tube around the pipe, `thick` meters larger.
    fn sleeve(&self, builder: &mut SiteBuilder, [from, to]: [f32; 2], thick: f32) {
        builder.tube(self.axis(from), self.axis(to), self.radius + thick);
    }

    /// The point of the ground under the pipe.
    fn ground_point(&self, distance: f32) -> Vec3 {
        self.along * distance
    }
}

pub(crate) fn site(seed: u64, burial: Option<f32>) -> Site {
    let dice = Choices::new(seed, "pipeline");
    let mut builder = SiteBuilder::new(seed, "pipeline");
    let kind = dice.count(0, 0, 4);
    // Bags or rock support a pipe on the ground.
    let kind = if burial.is_some() { 3 + kind % 2 } else { kind };
    let radius = dice.uniform(1, 0.16, 0.5);
    let clearance = match (burial, kind) {
        (Some(share), _) => -2.0 * radius * share,
        (None, 0 | 1) => dice.uniform(2, 0.15, 0.55),
        (None, 2) => dice.uniform(2, 0.7, 1.6),
        (None, _) => -radius * dice.uniform(2, 0.25, 0.9),
    };
    let yaw = dice.uniform(3, -0.5, 0.5);
    let pipe = Pipe {
        radius,
        height: radius + clearance,
        yaw,
        along: horizontal(yaw),
        across: horizontal(yaw + FRAC_PI_2),
    };
    let joint = dice.uniform(4, -1.3, 1.3);
    let coat = Coat {
        radius,
        joint: HALF_M + joint,
        pitch: 12.2,
        band: dice.uniform(5, 0.16, 0.32),
        band_color: dice.pick(6, &BANDS),
        seam: dice.uniform(7, -3.1, 3.1),
    };
    builder.object(Material::Coated(coat), Category::Pipe);
    builder.tube(pipe.axis(-HALF_M), pipe.axis(HALF_M), radius);
    match kind {
        0 => blocks(&mut builder, dice, &pipe),
        1 => saddles(&mut builder, dice, &pipe),
        2 => trestles(&mut builder, dice, &pipe),
        3 => bags(&mut builder, dice, &pipe),
        _ => berm(&mut builder, dice, &pipe),
    }
    fittings(&mut builder, dice, &pipe, joint);
    builder.stones(
        dice.count(8, 3, 12),
        pipe.ground_point(0.4),
        [4.0, 2.4],
        [0.05, 0.3],
    );
    builder.debris(dice.count(9, 1, 4), pipe.ground_point(0.0), [3.5, 2.4]);
    for i in 0..dice.count(10, 1, 3) {
        let ground = builder.dice_for("ground").object(i);
        let place = ground.point_in(0, [-7.0, 1.5, 0.0], [7.0, 9.0, 0.0]);
        let radius = ground.uniform(2, 1.2, 4.0);
        builder.mound(place, radius, radius * ground.uniform(3, 0.05, 0.11));
    }
    builder.site(&view(dice, &pipe, kind > 2))
}

/// A view across the pipe, or along it as in a survey.
fn view(dice: Choices, pipe: &Pipe, buried: bool) -> SiteView {
    let beside = dice.chance(20, 0.55);
    // Look over the banks of a buried pipe.
    let least = if buried { 0.9 } else { 0.4 };
    let (eye, target) = if beside {
        let distance = pipe.radius + dice.uniform(21, 1.1, 2.8);
        let abreast = pipe.axis(dice.uniform(22, -1.2, 1.2));
        let eye = abreast - pipe.across * distance + UP * dice.uniform(23, -0.1, 1.3);
        (eye, pipe.axis(dice.uniform(24, -0.6, 0.6)))
    } else {
        let behind = pipe.axis(-dice.uniform(21, 1.4, 2.6));
        let over = UP * (pipe.radius + dice.uniform(23, 0.6, 1.4));
        let eye = behind + pipe.across * dice.uniform(22, -1.0, 1.0) + over;
        let ahead = pipe.axis(dice.uniform(24, 0.4, 2.2));
        (eye, ahead + UP * dice.uniform(25, -0.2, 0.3))
    };
    let eye = vec3(eye.x, eye.y, eye.z.max(least));
    SiteView {
        eye,
        target,
        travel: pipe.along * 5.0,
        roll: dice.uniform(26, -0.1, 0.1),
        lamp_m: (target - eye).length() * dice.uniform(27, 0.9, 1.3),
        ambient: dice.uniform(28, 0.06, 0.32),
        floor: 0.0,
        heights: Heights::Camera([least, pipe.height.max(least) + 1.4]),
        stretch: [0.8, 1.8],
        turn_deg: 20.0,
        least_structure: 0.08,
    }
}

/// Bracelet anodes, a flange, and straps with a cable on top.
fn fittings(builder: &mut SiteBuilder, dice: Choices, pipe: &Pipe, joint: f32) {
    let half = dice.uniform(30, 0.18, 0.3);
    for place in [joint - dice.uniform(31, 0.8, 2.4), joint + 5.1, joint - 8.3] {
        builder.object(Material::Anode, Category::Anode);
        for side in [-1.0, 1.0] {
            // Two shells with a gap between them.
            let (near, far) = (place + side * 0.012, place + side * half);
            pipe.sleeve(builder, [near.min(far), near.max(far)], 0.045);
        }
    }
    if dice.chance(32, 0.4) {
        let place = pipe.axis(joint + dice.uniform(33, 1.2, 2.6));
        builder.flange(place, pipe.along, pipe.radius);
    }
    if dice.chance(34, 0.4) {
        builder.object(Material::Rubber, Category::Cable);
        let top = UP * (pipe.radius + 0.045);
        builder.tube(pipe.axis(-HALF_M) + top, pipe.axis(HALF_M) + top, 0.045);
        builder.object(Material::Steel, Category::Fitting);
        for i in -8..8 {
            let place = 1.35 * i as f32 + dice.uniform(35, 0.0, 1.0);
            pipe.sleeve(builder, [place - 0.025, place + 0.025], 0.012);
        }
    }
}

/// Numbers and positions of the supports along the pipe, ahead and behind.
fn places(dice: Choices, spacing: f32) -> impl Iterator<Item = (u64, f32)> {
    let start = dice.uniform(40, -0.5, 0.5) * spacing;
    (0..6u64).map(move |i| {
        let jitter = dice.uniform(41 + i, -0.1, 0.1);
        (i, start + spacing * (i as f32 - 2.0 + jitter))
    })
}

/// Plain concrete blocks.
fn blocks(builder: &mut SiteBuilder, dice: Choices, pipe: &Pipe) {
    for (i, place) in places(dice, dice.uniform(39, 1.9, 3.4)) {
        builder.object(Material::Concrete(JointPattern::Boards), Category::Support);
        let height = (pipe.height - pipe.radius) / 2.0 + 0.05;
        let half = vec3(0.18, pipe.radius * dice.uniform(50 + i, 1.2, 2.2), height);
        builder.block(pipe.ground_point(place) + UP * height, half, pipe.yaw);
        scour(
            builder,
            dice.object(i as usize + 1),
            pipe.ground_point(place),
            half.y,
        );
    }
}

/// Blocks with cheeks on both sides of the pipe and a strap over it.
fn saddles(builder: &mut SiteBuilder, dice: Choices, pipe: &Pipe) {
    for (i, place) in places(dice, dice.uniform(39, 2.2, 3.8)) {
        builder.object(Material::Concrete(JointPattern::Boards), Category::Support);
        let base = (pipe.height - pipe.radius) / 2.0 + 0.04;
        let wide = pipe.radius * 1.75;
        builder.block(
            pipe.ground_point(place) + UP * base,
            vec3(0.24, wide, base),
            pipe.yaw,
        );
        for side in [-1.0, 1.0] {
            let cheek = pipe.across * (side * (pipe.radius + 0.13));
            let half = vec3(0.2, 0.11, pipe.radius * 0.5);
            let center = pipe.ground_point(place) + cheek + UP * (pipe.height - pipe.radius * 0.55);
            builder.block(center, half, pipe.yaw);
        }
        builder.object(Material::Steel, Category::Fitting);
        pipe.sleeve(builder, [place - 0.04, place + 0.04], 0.014);
        scour(
            builder,
            dice.object(i as usize + 1),
            pipe.ground_point(place),
            wide,
        );
    }
}

/// Two posts with a beam, high above the ground.
fn trestles(builder: &mut SiteBuilder, dice: Choices, pipe: &Pipe) {
    for (i, place) in places(dice, dice.uniform(39, 2.8, 4.6)) {
        let wide = pipe.radius + dice.uniform(50 + i, 0.2, 0.4);
        let top = pipe.height - pipe.radius;
        builder.object(Material::Steel, Category::Support);
        for side in [-1.0, 1.0] {
            let foot = pipe.ground_point(place) + pipe.across * (side * wide * 1.25);
            let head = pipe.ground_point(place) + pipe.across * (side * wide) + UP * top;
            builder.tube(foot - UP * 0.3, head, 0.07);
            builder.tube(foot, foot + UP * 0.05, 0.22);
            scour(builder, dice.object(2 * i as usize + 1), foot, 0.3);
        }
        let beam = pipe.ground_point(place) + UP * (top - 0.08);
        builder.block(beam, vec3(0.09, wide + 0.15, 0.08), pipe.yaw);
    }
}

/// Stacks of bags under and along a pipe on the ground.
fn bags(builder: &mut SiteBuilder, dice: Choices, pipe: &Pipe) {
    bank(builder, dice, pipe);
    for (i, place) in places(dice, dice.uniform(39, 1.6, 3.2)) {
        builder.object(Material::Bag, Category::Support);
        // Staggered courses, each leaning on the pipe and on the course below.
        let courses = (((pipe.height + 0.2 * pipe.radius) / COURSE_M) as usize).clamp(1, 3);
        for bag in 0..4 * courses {
            let choose = dice.object(100 + 16 * i as usize + bag);
            let side = if bag % 2 == 0 { -1.0 } else { 1.0 };
            let course = (bag / 4) as f32;
            let height = COURSE_M * (course + 0.35);
            let aside = height - pipe.height;
            let wide = (pipe.radius * pipe.radius - aside * aside).max(0.0).sqrt();
            let out = wide + 0.15 + choose.uniform(0, 0.0, 0.06) + 0.04 * (2.0 - course);
            let step = 0.24 * if bag / 2 % 2 == 0 { -1.0 } else { 1.0 } + 0.12 * course;
            let center = pipe.ground_point(place + step + choose.uniform(1, -0.04, 0.04))
                + pipe.across * (side * out)
                + UP * height;
            let radii = vec3(choose.uniform(2, 0.27, 0.31), 0.2, 0.105);
            builder.ball(center, radii, pipe.yaw + choose.uniform(3, -0.2, 0.2));
        }
    }
}

/// Dumped rock along the pipe.
fn berm(builder: &mut SiteBuilder, dice: Choices, pipe: &Pipe) {
    bank(builder, dice, pipe);
    let side = if dice.chance(60, 0.5) { 1.0 } else { -1.0 };
    let place = pipe.ground_point(dice.uniform(61, -1.5, 1.5)) + pipe.across * (side * pipe.radius);
    for (count, reach, sizes) in [(14, [1.5, 0.5], [0.08, 0.2]), (10, [2.4, 0.8], [0.05, 0.12])] {
        builder.stones(count, place, reach, sizes);
    }
}

/// Sand banked along a pipe on the ground.
fn bank(builder: &mut SiteBuilder, dice: Choices, pipe: &Pipe) {
    for i in 0..7 {
        let choose = dice.object(200 + i);
        let place = pipe.ground_point(-7.0 + 2.6 * i as f32 + choose.uniform(0, -0.6, 0.6))
            + pipe.across * choose.uniform(1, -0.5, 0.5);
        let wide = choose.uniform(2, 0.9, 1.8);
        builder.mound(place, wide, wide * choose.uniform(3, 0.05, 0.12));
    }
}

/// Sand heaped against a support.
fn scour(builder: &mut SiteBuilder, dice: Choices, place: Vec3, wide: f32) {
    let reach = wide * dice.uniform(70, 1.2, 1.7) + 0.2;
    let lee = dice.uniform(71, -0.25, 0.25);
    let height = reach * dice.uniform(72, 0.06, 0.16);
    builder.mound(place + vec3(lee, lee, 0.0), reach, height);
}
