//! Traces light from a lamp, for tables: independent of the paths from the camera, and without their heavy tail.
//!
//! The geometry is symmetric about the axis of the lamp, which is at the origin and shines along z; cameras are in the
//! plane z = 0 at several distances from it and look in the plane through the axis; black walls are at several z. A
//! photon's free paths are sampled from b, absorption reduces its weight. Light scattered by more than 50 degrees is
//! rare, but it is the light that a camera next to the lamp receives: each event splits it off, so every photon
//! contributes. Each event is connected to the direction of each look, over a disc of 5 degrees instead of a point. By
//! symmetry an event at the distance q from the axis and at the depth z is visible from the point where its line of
//! sight crosses z = 0. One path serves all walls beyond its maximum depth. The error falls as the root of the photons.

mod bench;
mod disc;
mod tally;

use std::f64::consts::PI;
use std::ops::Range;

use imaging::cancel;
use imaging::random::Stream;
use imaging::vector::{DVec3, vec3};

use crate::phase::{Phase, tilt};
use crate::water::WaterCoefficients;
use bench::Photon;
pub use bench::{AirlightLevels, Bench, Shone};
use disc::LookDisc;
use tally::PhotonTally;

/// Batches; the errors follow from their scatter.
const BATCHES: usize = 16;
/// Wider scattering is split off, degrees.
const WIDE_DEG: f64 = 50.0;
/// Photons of smaller weight undergo Russian roulette.
const LIGHT: f64 = 0.01;
/// Limit on scattering events; the weight limit ends photons long before.
const MOST_EVENTS: usize = 4096;

impl Bench {
    /// Follows the photons of a range of numbers, each with independent random numbers.
    #[must_use]
    pub fn shine(&self, phase: &Phase, seed: u64, photons: Range<u64>) -> Shone {
        let mut tallies = vec![PhotonTally::new(self); BATCHES];
        let mut follower = Follower::new(self, phase, seed);
        for photon in photons.clone() {
            if photon % 256 == 0 {
                cancel::check();
            }
            follower.follow(photon, &mut tallies[(photon % BATCHES as u64) as usize]);
        }
        let count = photons.end - photons.start;
        PhotonTally::levels(
            self,
            &tallies,
            self.power() * BATCHES as f64 / count as f64,
            count,
        )
    }

    /// The power of the lamp: the integral of its profile over the sphere.
    fn power(&self) -> f64 {
        self.cone_deg
            .map_or(4.0 * PI, |cone| PI * (1.0 - cone.to_radians().cos()))
    }
}

struct Follower<'a> {
    bench: &'a Bench,
    phase: &'a Phase,
    disc: LookDisc,
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
            disc: LookDisc::new(phase),
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

    /// Follows a photon with all parts split off it.
    fn follow(&mut self, photon: u64, tally: &mut PhotonTally) {
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

    /// A direction by the lamp's profile, which is linear in the cosine within the cone.
    fn emitted(&mut self) -> DVec3 {
        let (height, azimuth) = (self.draw(), self.draw());
        let versine = match self.bench.cone_deg {
            None => 2.0 * height,
            Some(cone) => (1.0 - cone.to_radians().cos()) * (1.0 - height.sqrt()),
        };
        tilt(vec3(0.0, 0.0, 1.0), versine, azimuth)
    }

    fn go(&mut self, mut photon: Photon, tally: &mut PhotonTally) {
        let WaterCoefficients {
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

    /// Queues the widely scattered part of a photon.
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

    /// A direction after scattering, between two shares of the phase function.
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
