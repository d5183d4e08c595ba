//! Random frames of water alone: every size from a pixel on, every water, both forms of forward scatter.

use imaging::random::Stream;
use imaging::{Plane, Rgb};
use optics::water::Water;

use super::adversary::adversary;
use super::random_water::RandomWater;
use super::scene::RandomScene;

/// A frame to try.
#[derive(Debug, Clone)]
pub(super) struct Case {
    /// Which one.
    pub(super) seed: u64,
    /// Form, water, course of the range and of the light.
    pub(super) about: String,
    /// Linear light.
    pub(super) radiance: Rgb<f32>,
    /// Meters along the ray.
    pub(super) range: Plane<f32>,
    /// The water.
    pub(super) water: Water,
    /// The error that is allowed.
    pub(super) tolerance: f64,
}

/// Longest side of a random frame, pixels.
const LONGEST_PX: usize = 80;
/// One of this many frames is made against the bound.
const ADVERSARIES: u64 = 40;

/// The frame of a seed.
pub(super) fn case(seed: u64) -> Case {
    let adversary = (seed % ADVERSARIES == ADVERSARIES - 1)
        .then(|| adversary(seed))
        .flatten();
    adversary.unwrap_or_else(|| random(seed))
}

fn random(seed: u64) -> Case {
    let stream = Stream::stage(seed, "campaign");
    let unit = |what: u64| stream.unit(u64::MAX, what);
    let scene = RandomScene::draw(&stream, LONGEST_PX);
    let drawn = RandomWater::draw(&unit);
    Case {
        seed,
        about: format!("{}, {}", drawn.name, scene.about),
        radiance: scene.radiance,
        range: scene.range,
        water: drawn.water,
        tolerance: tolerance(unit(30)),
    }
}

/// From 0.03 down to 3e-6, for a number from 0 to 1.
pub(super) fn tolerance(unit: f64) -> f64 {
    10f64.powf(-1.5 - 4.0 * unit)
}
