//! Light followed from a lamp, for tables: independent of the paths from the camera, and without their tail.
//!
//! The geometry is symmetric about the axis of the lamp: it stands at the origin and shines along z; cameras stand in the plane z = 0
//! at some distances from it and look in the plane through the axis; black walls stand at some z. A photon's free paths follow b
//! alone, absorption weakens it. Light that is scattered by more than 50 degrees is rare and is what a camera beside the lamp sees:
//! each event splits it off, so every photon meets it. Each event is joined to the direction of each look, over a disc of 5 degrees
//! and not one point; by symmetry an event at the distance q from the axis and at the depth z is seen from where its line of sight
//! crosses z = 0. One path serves all walls: those deeper than it has been. The error falls as the root of the photons.

mod disc;
mod tally;

use std::f64::consts::PI;
use std::ops::Range;

use imaging::cancel;
use imaging::random::Stream;
use imaging::vector::{DVec3, vec3};

use crate::estimate::Level;
use crate::phase::{Phase, about};
use crate::water::Coefficients;
use disc::Disc;
use tally::Tally;

/// Batches from whose scatter the errors follow.
const BATCHES: usize = 16;
/// What is scattered by more than this is split off, degrees.
const WIDE_DEG: f64 = 50.0;
/// Photons that weigh less play roulette.
const LIGHT: f64 = 0.01;
/// Scatterings after which a photon is given up; at the weights above none gets there.
const MOST_EVENTS: usize = 4096;

/// What is lit and seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Bench {
    /// The water.
    pub water: Coefficients,
    /// Half angle of the lamp's cone, degrees; none: it shines in all directions.
    pub cone_deg: Option<f64>,
    /// Depths of black walls, rising, m; infinite for water without end.
    pub walls_m: Vec<f64>,
    /// Angles of the looks from z, positive away from the lamp, degrees.
    pub looks_deg: Vec<f64>,
    /// Distances of the cameras from the lamp: nearest and farthest of each bin, m.
    pub cameras_m: Vec<[f64; 2]>,
    /// Rings on the walls: angles at the lamp from its axis, rising, degrees.
    pub rings_deg: Vec<f64>,
}

/// What cameras see and walls receive, for an intensity of 1 on the axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Shone {
    /// Radiance of the water's glow by look, wall and camera: scattered once, and in all.
    pub glow: Vec<Vec<Vec<Glow>>>,
    /// Mean irradiance of scattered light by wall and ring.
    pub scattered: Vec<Vec<Level>>,
    /// Photons.
    pub photons: u64,
}

/// The glow that one camera sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Glow {
    /// Scattered once.
    pub once: Level,
    /// Scattered once or more often.
    pub all: Level,
}

/// A photon, or a part of one.
#[derive(Debug, Clone, Copy)]
struct Photon {
    place: DVec3,
    direction: DVec3,
    weight: f64,
    deepest: f64,
    order: usize,
}

impl Bench {
    /// Follows photons; each number of a range is one of them, with random numbers of its own.
    #[must_use]
    pub fn shine(&self, phase: &Phase, seed: u64, photons: Range<u64>) -> Shone {
        let mut tallies = vec![Tally::new(self); BATCHES];
        let mut follower = Follower::new(self, phase, seed);
        for photon in photons.clone() {
            if photon % 256 == 0 {
                cancel::check();
            }
            follower.follow(photon, &mut tallies[(photon % BATCHES as u64) as usize]);
        }
        let count = photons.end - photons.start;
        Tally::levels(
            self,
            &tallies,
            self.power() * BATCHES as f64 / count as f64,
            count,
        )
    }

    /// All light of the lamp: the integral of its profile over the sphere.
    fn power(&self) -> f64 {
        self.cone_deg
            .map_or(4.0 * PI, |cone| PI * (1.0 - cone.to_radians().cos()))
    }
}

struct Follower<'a> {
    bench: &'a Bench,
    phase: &'a Phase,
    disc: Disc,
    /// Share of the light that is not split off.
    narrow: f64,
    stream: Stream,
    photon: u64,
    drawn: u64,
    stack: Vec<Photon>,
}

impl<'a> Follower<'a> {
    fn new(bench: &'a Bench, phase: &'a Phase, seed: u64) -> Self {
        Self {
            bench,
            phase,
            disc: Disc::new(phase),
            narrow: phase.share_within(1.0 - WIDE_DEG.to_radians().cos()),
            stream: Stream::stage(seed, "lantern"),
            photon: 0,
            drawn: 0,
            stack: Vec::new(),
        }
    }

    fn draw(&mut self) -> f64 {
        self.drawn += 1;
        self.stream.unit(self.photon, self.drawn)
    }

    /// Follows a photon with all that is split off it.
    fn follow(&mut self, photon: u64, tally: &mut Tally) {
        (self.photon, self.drawn) = (photon, 0);
        let direction = self.emitted();
        self.stack.push(Photon {
            place: vec3(0.0, 0.0, 0.0),
            direction,
            weight: 1.0,
            deepest: 0.0,
            order: 0,
        });
        while let Some(part) = self.stack.pop() {
            self.go(part, tally);
        }
    }

    /// A direction by the lamp's profile, which rises evenly in the cosine within the cone.
    fn emitted(&mut self) -> DVec3 {
        let (height, azimuth) = (self.draw(), self.draw());
        let versine = match self.bench.cone_deg {
            None => 2.0 * height,
            Some(cone) => (1.0 - cone.to_radians().cos()) * (1.0 - height.sqrt()),
        };
        about(vec3(0.0, 0.0, 1.0), versine, azimuth)
    }

    fn go(&mut self, mut photon: Photon, tally: &mut Tally) {
        let Coefficients {
            absorption,
            scattering,
        } = self.bench.water;
        let last = self.bench.walls_m.last().copied().unwrap_or(0.0);
        if scattering <= 0.0 {
            return;
        }
        for _ in 0..MOST_EVENTS {
            let free = -(-self.draw()).ln_1p() / scattering;
            tally.cross(self.bench, &photon, free);
            photon.place = photon.place + photon.direction * free;
            photon.weight *= (-absorption * free).exp();
            photon.deepest = photon.deepest.max(photon.place.z);
            photon.order += 1;
            if photon.deepest >= last {
                return;
            }
            tally.join(self.bench, &self.disc, &photon);
            self.split(&photon);
            photon.weight *= self.narrow;
            photon.direction = self.turned(photon.direction, 0.0, self.narrow);
            if !self.survives(&mut photon) {
                return;
            }
        }
    }

    /// Puts aside the part of a photon that is scattered widely.
    fn split(&mut self, photon: &Photon) {
        let mut wide = Photon {
            weight: photon.weight * (1.0 - self.narrow),
            ..*photon
        };
        if self.survives(&mut wide) {
            wide.direction = self.turned(photon.direction, self.narrow, 1.0);
            self.stack.push(wide);
        }
    }

    /// A direction after scattering, among the shares of the phase function between two.
    fn turned(&mut self, direction: DVec3, from: f64, to: f64) -> DVec3 {
        let unit = from + self.draw() * (to - from);
        let azimuth = self.draw();
        self.phase.turn(direction, [unit, azimuth])
    }

    fn survives(&mut self, photon: &mut Photon) -> bool {
        if photon.weight >= LIGHT {
            return true;
        }
        let lives = self.draw() * LIGHT < photon.weight;
        photon.weight = LIGHT;
        lives
    }
}

#[cfg(test)]
mod tests;
