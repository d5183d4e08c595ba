//! Biota and suspended objects of a site: growth with relief, ropes, animals and bubbles.
//!
//! Growth sits where rays from near the usual view meet structures and stones. A ray of solid angle Ω that meets a
//! surface at range r under the angle θ represents the area `Ω r²/cos θ` and carries growth with probability area ×
//! density, at most 1. Growth therefore has the requested density up to that limit, and none is built out of sight.
//! Animals and bubbles are uniform in a ball around the view. The biota of a world do not depend on the camera.

mod body;
mod free;
mod growth;

use std::f32::consts::{PI, TAU};

use imaging::vector::{Vec3, vec3};
use spec::Life;

use crate::site::Site;
use crate::site::builder::SiteBuilder;
use crate::site::chance::Choices;
use crate::site::pose::{UP, up};
use crate::site::solid::Solid;
use crate::site::tree::Tree;

/// Rays that sample surfaces for growth.
const RAYS: usize = 12_000;
/// Maximum range of growth, m.
const REACH_M: f32 = 8.0;
/// Radius around the middle of the view for animals and bubbles, m.
const BALL_M: f32 = 4.0;
/// Minimum distance of animals and bubbles from the usual eye and from surfaces, m.
const CLEAR_M: f32 = 0.25;
/// Lower limit of the cosine of a grazing ray.
const GRAZING: f32 = 0.15;
/// Side of the cells that vary the density of growth, m.
const PATCH_M: f32 = 0.35;
/// Limit on biota solids: each costs some microseconds a frame.
const MOST_SOLIDS: usize = 9_000;

/// A surface sample.
#[derive(Debug, Clone, Copy)]
struct GrowthSite {
    place: Vec3,
    normal: Vec3,
    host: u16,
    /// Distance from the usual eye, m.
    range: f32,
    /// Represented area, m².
    area: f32,
}

/// Adds biota to a site; `seed` is that of the scene.
pub(crate) fn settle(site: &mut Site, life: &Life, seed: u64) {
    let eye = site.pose.position_m.as_f32();
    let target = site.target.as_f32();
    let mut colony = Colony {
        builder: SiteBuilder::from_site(site, seed, "life"),
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
            Colony::mussels as fn(&mut Colony, Choices, &GrowthSite),
        ),
        ("worms", life.worms, Colony::worms),
        ("weed", life.weed, Colony::weed),
    ] {
        let dice = Choices::new(seed, &format!("life/{topic}"));
        for (at, spot) in spots.iter().enumerate() {
            let own = dice.object(at);
            // Growth clusters: most cells are bare, a few are crowded.
            let share = density as f32 * spot.area * crowding(dice, spot.place);
            let dice = own;
            if density > 0.0 && dice.chance(0, share) && colony.has_room() {
                grow(&mut colony, dice, spot);
            }
        }
    }
    for rope in 0..life.ropes {
        colony.rope(Choices::new(seed, "life/rope").object(rope), &spots);
    }
    let volume = f64::from(4.0 / 3.0 * PI * BALL_M.powi(3));
    for (topic, density, place) in [
        ("fish", life.fish, Colony::fish as fn(&mut Colony, Choices, Vec3)),
        ("jellyfish", life.jellyfish, Colony::jellyfish),
        ("bubbles", life.bubbles, Colony::bubble),
    ] {
        let dice = Choices::new(seed, &format!("life/{topic}"));
        let count = density * volume + f64::from(dice.uniform(0, 0.0, 1.0));
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

/// Solids being added to a site.
struct Colony {
    builder: SiteBuilder,
    eye: Vec3,
    /// The middle of the visible water.
    middle: Vec3,
    stage: Vec<Solid>,
}

impl Colony {
    fn has_room(&self) -> bool {
        self.builder.count() < MOST_SOLIDS
    }

    /// A point in open water; `None` if something is near.
    fn free_place(&self, dice: Choices) -> Option<Vec3> {
        let radius = BALL_M * libm::cbrtf(dice.uniform(0, 0.0, 1.0));
        let place = self.middle + direction(dice, 1) * radius;
        let solids = self.stage.iter().map(|solid| solid.distance(place));
        let clear = solids.fold(place.z, f32::min).min((place - self.eye).length());
        (clear > CLEAR_M).then_some(place)
    }
}

/// Factor on the density of growth at a point: 0 in some cells, with mean 1.
fn crowding(dice: Choices, place: Vec3) -> f32 {
    let cell = [place.x, place.y, place.z].map(|v| libm::floorf(v / PATCH_M) as i32 as usize & 0x3ff);
    let share = dice
        .object((1 << 40) + (cell[0] << 20) + (cell[1] << 10) + cell[2])
        .uniform(0, 0.0, 1.0);
    // The integral of 3 s² is 1.
    3.0 * share * share
}

/// A uniformly distributed direction, from two choices.
fn direction(dice: Choices, choice: u64) -> Vec3 {
    let rise = dice.uniform(choice, -1.0, 1.0);
    let (sin, cos) = libm::sincosf(dice.uniform(choice + 1, 0.0, TAU));
    let flat = (1.0 - rise * rise).max(0.0).sqrt();
    vec3(flat * cos, flat * sin, rise)
}

/// Two unit vectors orthogonal to a unit vector and to each other.
fn tangents(normal: Vec3) -> [Vec3; 2] {
    let helper = if normal.z.abs() < 0.9 {
        UP
    } else {
        vec3(1.0, 0.0, 0.0)
    };
    let x = helper.cross(normal).normalized();
    [x, normal.cross(x)]
}

/// Samples structures and stones by rays from near the camera's usual track.
fn spots(site: &Site, eye: Vec3, seed: u64) -> Vec<GrowthSite> {
    let tree = Tree::new(&site.solids);
    let dice = Choices::new(seed, "life/spots");
    let travel = site.travel.as_f32();
    let solid_angle = 4.0 * PI / RAYS as f32;
    let found = (0..RAYS).filter_map(|ray| {
        let dice = dice.object(ray);
        let start = eye + travel * dice.uniform(0, -0.4, 0.4);
        let nearest = site.solids.iter().map(|solid| solid.distance(start));
        // A displaced eye may be inside a wall and see only its back; fall back to the usual eye.
        let start = if ray % 2 == 0 || nearest.fold(start.z, f32::min) < 0.05 {
            eye
        } else {
            start
        };
        let heading = direction(dice, 1);
        let (met, number) = tree.first_met(&site.solids, start, heading, REACH_M)?;
        let solid = &site.solids[usize::from(number)];
        if solid.object == 0 {
            return None;
        }
        let place = start + heading * met;
        if place.z < 0.0 {
            return None;
        }
        let normal = solid.normal(place, 1e-3);
        let facing = (-heading.dot(normal)).max(GRAZING);
        Some(GrowthSite {
            place,
            normal,
            host: solid.object,
            range: (place - eye).length(),
            area: solid_angle * met * met / facing,
        })
    });
    found.collect()
}

/// Raises a point to at least `least` meters above the ground.
fn above_ground(place: Vec3, least: f32) -> Vec3 {
    if place.z < least {
        place + up(least - place.z)
    } else {
        place
    }
}
