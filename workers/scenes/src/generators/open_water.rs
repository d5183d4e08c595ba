//! The family `open-water`: posts, mooring lines, buoys, hanging crates and cables in mid-water. The bottom is out of
//! sight.

use imaging::vector::{Vec3, vec3};

use crate::categories::Category;
use crate::site::Site;
use crate::site::builder::{Heights, SiteBuilder, SiteView};
use crate::site::chance::Choices;
use crate::site::finish::{Material, SurfaceFinish};
use crate::site::pose::{Pose, UP, horizontal, up};
use crate::site::solid::Ring;

/// Origin of camera heights above the bottom, m: farther than any picture shows.
const FLOOR_M: f32 = 66.0;
/// Height of the camera's target above [`FLOOR_M`], m.
const MIDDLE_M: f32 = 6.0;
/// Half length of objects that extend out of sight in both directions, m.
const HALF_LENGTH_M: f32 = 30.0;
/// Pitch of chain links relative to their size.
const LINK_PITCH: f32 = 1.55;
const CHAIN_LINKS: usize = 48;
const BOW_PARTS: usize = 48;
const FLOATS: [[f32; 3]; 4] = [
    [0.5, 0.2, 0.03],
    [0.52, 0.42, 0.05],
    [0.5, 0.5, 0.47],
    [0.06, 0.07, 0.08],
];
const ROPES: [[f32; 3]; 4] = [
    [0.35, 0.3, 0.2],
    [0.06, 0.16, 0.2],
    [0.4, 0.16, 0.05],
    [0.12, 0.12, 0.11],
];

pub(crate) fn site(seed: u64, _: Option<f32>) -> Site {
    let dice = Choices::new(seed, "open-water");
    let mut builder = SiteBuilder::new(seed, "open-water");
    let target = up(FLOOR_M + MIDDLE_M);
    let kind = dice.count(0, 0, 4);
    item(&mut builder, dice.object(1), kind, target);
    for extra in 0..dice.count(1, 1, 4) {
        let own = dice.object(2 + extra);
        let aside = own.point_in(90, [-5.0, -1.0, -1.5], [5.0, 9.0, 1.5]);
        item(&mut builder, own, own.count(93, 0, 4), target + aside);
    }
    let distance = dice.uniform(2, 2.2, 4.0);
    let heading = horizontal(std::f32::consts::FRAC_PI_2 + dice.uniform(3, -0.9, 0.9));
    builder.site(&SiteView {
        eye: target - heading * distance,
        target,
        travel: heading.cross(UP) * (0.7 * distance),
        roll: dice.uniform(4, -0.12, 0.12),
        lamp_m: distance * dice.uniform(5, 0.85, 1.25),
        ambient: dice.uniform(6, 0.08, 0.35),
        floor: FLOOR_M,
        heights: Heights::Target([MIDDLE_M - 0.5, MIDDLE_M + 0.5]),
        stretch: [0.6, 1.8],
        turn_deg: 15.0,
        least_structure: 0.02,
    })
}

fn item(builder: &mut SiteBuilder, dice: Choices, kind: usize, place: Vec3) {
    match kind {
        0 => posts(builder, dice, place),
        1 => mooring(builder, dice, place),
        2 => buoy(builder, dice, place),
        3 => crate_on_slings(builder, dice, place),
        _ => cables(builder, dice, place),
    }
}

fn upright(dice: Choices, lean: f32) -> Vec3 {
    (UP + dice.shift(80, [lean, lean])).normalized()
}

fn rope(builder: &mut SiteBuilder, dice: Choices) {
    let material = Material::Body {
        color: dice.pick(70, &ROPES),
        gloss: 0.03,
        belly: 1.0,
    };
    builder.object_of(SurfaceFinish::new(material, dice), Category::Cable);
}

/// Thin posts in a row, some with collars.
fn posts(builder: &mut SiteBuilder, dice: Choices, place: Vec3) {
    let along = horizontal(dice.uniform(0, -0.9, 0.9)) * dice.uniform(1, 0.5, 1.8);
    let radius = dice.uniform(2, 0.02, 0.11);
    let material = dice.pick(3, &[Material::Steel, Material::Growth, Material::Steel]);
    for post in 0..dice.count(4, 1, 5) {
        builder.object(material, Category::Pile);
        let axis = upright(dice.object(100 + post), 0.04);
        let middle = place + along * post as f32;
        builder.tube(
            middle - axis * HALF_LENGTH_M,
            middle + axis * HALF_LENGTH_M,
            radius,
        );
        for collar in 0..dice.count(10 + post as u64, 0, 2) {
            let position = middle + axis * dice.uniform(20 + collar as u64, -2.0, 2.0);
            builder.tube(position, position + axis * 0.1, radius * 1.25);
        }
    }
}

/// A mooring line: a rope, or a chain that ends in ropes.
fn mooring(builder: &mut SiteBuilder, dice: Choices, place: Vec3) {
    let axis = upright(dice, 0.3);
    let radius = dice.uniform(0, 0.012, 0.035);
    let mut ends = [place, place];
    if dice.chance(1, 0.6) {
        builder.object(Material::Steel, Category::Cable);
        let size = dice.uniform(2, 0.06, 0.13);
        let pitch = LINK_PITCH * size;
        let sides = [axis.cross(vec3(0.0, 1.0, 0.0)).normalized(), vec3(0.0, 1.0, 0.0)];
        for link in 0..CHAIN_LINKS {
            let center = place + axis * ((link as f32 - 0.5 * CHAIN_LINKS as f32) * pitch);
            let ring = Ring::new(size, 0.24 * size, std::f32::consts::PI);
            builder.ring(ring, center, sides[link % 2], axis);
        }
        let half = 0.5 * CHAIN_LINKS as f32 * pitch;
        ends = [place - axis * half, place + axis * half];
    }
    rope(builder, dice);
    builder.tube(ends[0] - axis * HALF_LENGTH_M, ends[0], radius);
    builder.tube(ends[1], ends[1] + axis * HALF_LENGTH_M, radius);
}

/// A float with a band and eyes on its line.
fn buoy(builder: &mut SiteBuilder, dice: Choices, place: Vec3) {
    let radius = dice.uniform(0, 0.18, 0.7);
    let color = dice.pick(1, &FLOATS);
    let finish = if dice.chance(2, 0.4) {
        SurfaceFinish::new(Material::Steel, dice)
    } else {
        let material = Material::Body {
            color,
            gloss: 0.3,
            belly: 1.0,
        };
        SurfaceFinish::new(material, dice)
    };
    builder.object_of(finish, Category::Buoy);
    let height = radius * dice.pick(3, &[1.0, 1.0, 1.5]);
    builder.ball(place, vec3(radius, radius, height), 0.0);
    builder.tube(place - up(0.03), place + up(0.03), radius * 1.04);
    builder.object(Material::Steel, Category::Fitting);
    let eye = 0.16 * radius;
    for side in [-1.0, 1.0] {
        let ring = Ring::new(eye, 0.3 * eye, std::f32::consts::PI);
        builder.ring(ring, place + up(side * (height + eye)), vec3(0.0, 1.0, 0.0), UP);
    }
    rope(builder, dice);
    let below = place - up(height + 2.0 * eye);
    let line = dice.uniform(4, 0.008, 0.025);
    builder.tube(below - upright(dice, 0.1) * HALF_LENGTH_M, below, line);
    if dice.chance(5, 0.5) {
        let above = place + up(height + 2.0 * eye);
        builder.tube(above, above + up(HALF_LENGTH_M), line);
    }
}

fn corner(pose: &Pose, half: Vec3, sides: [f32; 3]) -> Vec3 {
    pose.point_out(half.zip(sides.into(), |half, side| half * side))
}

/// A crate or an open frame on four slings below a hoisting rope.
fn crate_on_slings(builder: &mut SiteBuilder, dice: Choices, place: Vec3) {
    let half = dice.point_in(0, [0.3, 0.25, 0.2], [0.9, 0.6, 0.6]);
    let yaw = dice.uniform(3, -1.5, 1.5);
    let pose = Pose::upright(place, yaw);
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    builder.object(Material::Steel, Category::Crate);
    for (i, (x, y)) in corners.into_iter().enumerate() {
        let (next_x, next_y) = corners[(i + 1) % 4];
        builder.tube(
            corner(&pose, half, [x, y, -1.0]),
            corner(&pose, half, [x, y, 1.0]),
            0.03,
        );
        for z in [-1.0, 1.0] {
            builder.tube(
                corner(&pose, half, [x, y, z]),
                corner(&pose, half, [next_x, next_y, z]),
                0.03,
            );
        }
    }
    // Closed, or open with a load on its floor.
    let fill = dice.pick(4, &[0.97, 0.97, 0.55]);
    builder.object(Material::Steel, Category::Crate);
    builder.block(
        place - up(half.z * (0.97 - fill)),
        vec3(half.x * 0.97, half.y * 0.97, half.z * fill),
        yaw,
    );
    let hook = place + up(half.z + dice.uniform(5, 0.6, 1.4));
    rope(builder, dice);
    for (x, y) in corners {
        builder.tube(corner(&pose, half, [x, y, 1.0]), hook, 0.01);
    }
    builder.tube(hook, hook + up(HALF_LENGTH_M), 0.014);
}

/// Cables and hoses that hang through the water in bows.
fn cables(builder: &mut SiteBuilder, dice: Choices, place: Vec3) {
    let along = horizontal(dice.uniform(0, -0.7, 0.7));
    for cable in 0..dice.count(1, 1, 4) {
        let own = dice.object(200 + cable);
        builder.object(Material::Rubber, Category::Cable);
        let radius = own.uniform(0, 0.012, 0.05);
        let half = own.uniform(2, 12.0, 30.0);
        let bow = Bow {
            lowest: place + own.point_in(3, [-0.5, -0.5, -0.4], [0.5, 1.5, 0.4]),
            half: along * half,
            sag: half * own.uniform(1, 0.1, 0.6),
        };
        for part in 0..BOW_PARTS {
            let (from, to) = (bow.point(part), bow.point(part + 1));
            builder.tube(from, to + (to - from).normalized() * radius, radius);
        }
    }
}

/// A cable that hangs between two ends at one height: a parabola.
struct Bow {
    lowest: Vec3,
    /// Half the vector between its ends.
    half: Vec3,
    sag: f32,
}

impl Bow {
    fn point(&self, part: usize) -> Vec3 {
        let share = 2.0 * part as f32 / BOW_PARTS as f32 - 1.0;
        self.lowest + self.half * share + up(self.sag * share * share)
    }
}
