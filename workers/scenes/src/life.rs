//! What lives on and about a site, and what hangs there: growth with relief, ropes, animals and bubbles.
//!
//! Growth stands where rays from about the usual view meet structures and stones: a ray that stands for the solid angle Ω and meets
//! a surface at the range r under the angle θ stands for the area `Ω r²/cos θ`, and carries growth with the chance of area ×
//! density, at most 1. So growth is as dense as asked up to where that is reached, and none is made that nobody sees. Animals
//! and bubbles are uniform in a ball about the view. A world has the same life whichever camera looks at it.

mod body;
mod free;
mod growth;

use std::f32::consts::{PI, TAU};

use imaging::vector::{Vec3, vec3};
use spec::Life;

use crate::site::Site;
use crate::site::builder::Builder;
use crate::site::chance::Dice;
use crate::site::pose::{UP, up};
use crate::site::solid::Solid;
use crate::site::tree::Tree;

/// Rays that look for places.
const RAYS: usize = 12_000;
/// Growth is looked for up to this range, m.
const REACH_M: f32 = 8.0;
/// Animals and bubbles are this near to the middle of the view, m.
const BALL_M: f32 = 4.0;
/// Nothing that swims or floats is nearer to the usual eye, or to anything else, m.
const CLEAR_M: f32 = 0.25;
/// The cosine that a grazing ray counts with at least.
const GRAZING: f32 = 0.15;
/// Side of the cells in which growth is more or less dense, m.
const PATCH_M: f32 = 0.35;
/// Most solids of all life: each costs some microseconds a frame.
const MOST_SOLIDS: usize = 9_000;

/// A place on a surface.
#[derive(Debug, Clone, Copy)]
struct Spot {
    place: Vec3,
    normal: Vec3,
    /// The object that it is on.
    host: u16,
    /// From the usual eye, m.
    range: f32,
    /// What the place stands for, m².
    area: f32,
}

/// Adds life to a site; `seed` is that of the scene.
pub(crate) fn settle(site: &mut Site, life: &Life, seed: u64) {
    let eye = site.pose.position_m.as_f32();
    let target = site.target.as_f32();
    let mut colony = Colony {
        builder: Builder::over(site, seed, "life"),
        eye,
        middle: eye + (target - eye) * 0.6,
        stage: site.solids.clone(),
    };
    let grows = life.mussels > 0.0 || life.worms > 0.0 || life.weed > 0.0;
    let spots = if grows || life.ropes > 0 {
        spots(site, eye, seed)
    } else {
        Vec::new()
    };
    for (topic, density, grow) in [
        (
            "mussels",
            life.mussels,
            Colony::mussels as fn(&mut Colony, Dice, &Spot),
        ),
        ("worms", life.worms, Colony::worms),
        ("weed", life.weed, Colony::weed),
    ] {
        let dice = Dice::new(seed, &format!("life/{topic}"));
        for (at, spot) in spots.iter().enumerate() {
            let own = dice.object(at);
            // What settles settles beside its like: nothing in most places, more in the others.
            let share = density as f32 * spot.area * crowding(dice, spot.place);
            let dice = own;
            if density > 0.0 && dice.chance(0, share) && colony.has_room() {
                grow(&mut colony, dice, spot);
            }
        }
    }
    for rope in 0..life.ropes {
        colony.rope(Dice::new(seed, "life/rope").object(rope), &spots);
    }
    let volume = f64::from(4.0 / 3.0 * PI * BALL_M.powi(3));
    for (topic, density, place) in [
        ("fish", life.fish, Colony::fish as fn(&mut Colony, Dice, Vec3)),
        ("jellyfish", life.jellyfish, Colony::jellyfish),
        ("bubbles", life.bubbles, Colony::bubble),
    ] {
        let dice = Dice::new(seed, &format!("life/{topic}"));
        let count = density * volume + f64::from(dice.between(0, 0.0, 1.0));
        for animal in 0..count as usize {
            let dice = dice.object(animal + 1);
            if let (Some(at), true) = (colony.free_place(dice), colony.has_room()) {
                place(&mut colony, dice, at);
            }
        }
    }
    let (solids, objects) = colony.builder.added();
    site.solids.extend(solids);
    site.objects = objects;
}

/// What is being added to a site.
struct Colony {
    builder: Builder,
    eye: Vec3,
    /// The middle of the water in view.
    middle: Vec3,
    stage: Vec<Solid>,
}

impl Colony {
    fn has_room(&self) -> bool {
        self.builder.count() < MOST_SOLIDS
    }

    /// A place in the open water; none where something is near.
    fn free_place(&self, dice: Dice) -> Option<Vec3> {
        let radius = BALL_M * libm::cbrtf(dice.between(0, 0.0, 1.0));
        let place = self.middle + direction(dice, 1) * radius;
        let solids = self.stage.iter().map(|solid| solid.distance(place));
        let clear = solids.fold(place.z, f32::min).min((place - self.eye).length());
        (clear > CLEAR_M).then_some(place)
    }
}

/// How many times as dense life is about a place: 0 in some cells, and 1 in the mean.
fn crowding(dice: Dice, place: Vec3) -> f32 {
    let cell = [place.x, place.y, place.z].map(|v| libm::floorf(v / PATCH_M) as i32 as usize & 0x3ff);
    let share = dice
        .object((1 << 40) + (cell[0] << 20) + (cell[1] << 10) + cell[2])
        .between(0, 0.0, 1.0);
    // The integral of 3 s² is 1.
    3.0 * share * share
}

/// A direction of the sphere, from two choices.
fn direction(dice: Dice, choice: u64) -> Vec3 {
    let rise = dice.between(choice, -1.0, 1.0);
    let (sin, cos) = libm::sincosf(dice.between(choice + 1, 0.0, TAU));
    let flat = (1.0 - rise * rise).max(0.0).sqrt();
    vec3(flat * cos, flat * sin, rise)
}

/// Two unit vectors at right angles to a unit vector and to each other.
fn beside(normal: Vec3) -> [Vec3; 2] {
    let helper = if normal.z.abs() < 0.9 {
        UP
    } else {
        vec3(1.0, 0.0, 0.0)
    };
    let x = helper.cross(normal).normalized();
    [x, normal.cross(x)]
}

/// Where rays from the usual way of the camera meet structures and stones.
fn spots(site: &Site, eye: Vec3, seed: u64) -> Vec<Spot> {
    let tree = Tree::new(&site.solids);
    let dice = Dice::new(seed, "life/spots");
    let travel = site.travel.as_f32();
    let solid_angle = 4.0 * PI / RAYS as f32;
    let found = (0..RAYS).filter_map(|ray| {
        let dice = dice.object(ray);
        let from = eye + travel * dice.between(0, -0.4, 0.4);
        let nearest = site.solids.iter().map(|solid| solid.distance(from));
        // Somebody who stands in a wall sees nothing; only a moved eye can.
        let from = if ray % 2 == 0 || nearest.fold(from.z, f32::min) < 0.05 {
            eye
        } else {
            from
        };
        let heading = direction(dice, 1);
        let (met, number) = tree.first_met(&site.solids, from, heading, REACH_M)?;
        let solid = &site.solids[usize::from(number)];
        if solid.object == 0 {
            return None;
        }
        let place = from + heading * met;
        if place.z < 0.0 {
            return None;
        }
        let normal = solid.normal(place, 1e-3);
        let facing = (-heading.dot(normal)).max(GRAZING);
        Some(Spot {
            place,
            normal,
            host: solid.object,
            range: (place - eye).length(),
            area: solid_angle * met * met / facing,
        })
    });
    found.collect()
}

/// Height of a place above the ground is kept at this at least, m.
fn above_ground(place: Vec3, least: f32) -> Vec3 {
    if place.z < least {
        place + up(least - place.z)
    } else {
        place
    }
}
