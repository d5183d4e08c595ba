//! What stands where, and where the camera is: six kinds of site, each with its own choices.

mod build;

use imaging::geometry::Intrinsics;

use super::camera::Camera;
use super::chance::Dice;
use super::finish::Finish;
use super::solid::Solid;
use super::vector::{Vec3, vec3};
use build::Builder;

/// A site with its camera and light.
pub(super) struct Site {
    pub(super) solids: Vec<Solid>,
    pub(super) finishes: Vec<Finish>,
    pub(super) camera: Camera,
    pub(super) seabed: Finish,
    /// Distance at which the lamp gives full light, m.
    pub(super) lamp_m: f32,
    /// Light from above, relative to that.
    pub(super) ambient: f32,
}

impl Site {
    /// The site of a seed.
    pub(super) fn of(seed: u64, size: (usize, usize), lens: &Intrinsics) -> Self {
        let dice = Dice::about(seed, "structure");
        let mut builder = Builder::new(seed);
        let kind = dice.count(0, 0, 5);
        let (target, distance) = match kind {
            0 => builder.single_pile(),
            1 => builder.pile_row(),
            2 => builder.braced_legs(),
            3 => builder.pipeline(),
            4 => builder.plate_wall(),
            _ => builder.frame_of_beams(),
        };
        builder.stones(dice.count(1, 2, 9));
        let distance = distance * dice.between(2, 0.8, 1.35);
        let azimuth = dice.between(3, -0.9, 0.9);
        let side = vec3(libm::sinf(azimuth), -libm::cosf(azimuth), 0.0);
        let lift = dice.between(4, -0.12, 0.45) * distance;
        let eye = target + side * distance + vec3(0.0, 0.0, lift);
        let eye = vec3(eye.x, eye.y, eye.z.max(0.5));
        let aim = target + vec3(dice.between(5, -0.2, 0.2), 0.0, dice.between(6, -0.15, 0.1)) * distance;
        let camera = Camera::looking(eye, aim, dice.between(7, -0.09, 0.09), size, lens);
        let (solids, finishes) = builder.finish();
        let seabed = Finish::seabed(dice);
        Self {
            solids,
            finishes,
            camera,
            seabed,
            lamp_m: (aim - eye).length() * dice.between(8, 0.85, 1.25),
            ambient: dice.between(9, 0.08, 0.35),
        }
    }
}

/// Where to look, and from how far away, in metres.
pub(super) type View = (Vec3, f32);
