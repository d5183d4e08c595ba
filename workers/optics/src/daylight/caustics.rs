//! Caustics: the pattern that waves on the surface draw with sunlight, on a tile that repeats. Its mean is 1 everywhere.
//!
//! The surface is a sum of 24 waves with lengths between 15 cm and half a tile that fit into the tile. Each point of the surface
//! refracts the incident light by `(1 − 1/n)` times its slope, so that at depth z it arrives shifted sideways by z times that
//! angle. The light is collected in the cells of a tile. The disc of the sun and forward scatter blur the tile: its spectrum at f
//! cycles a meter is multiplied by
//!
//! ```text
//! M(f) = e^{−2π² f² (0.0017 z)²} [ e^{−c z} + (e^{−G z} − e^{−c z}) ((1 − m) e^{−2π f z g₁} + m e^{−2π f z g₂}) ] / e^{−G z}
//! ```
//!
//! with the two kernels of the forward scatter at the range z, so that contrast fades in turbid water. M is taken from the channel
//! with the median c. The slope of the waves is after Cox and Munk (1954): 0.055 in a calm, 0.2 at a wind of 7 m/s.

mod lookup;
mod reference;
mod shafts;
mod tile;

pub use lookup::{caustics, caustics_reference};
pub use reference::{RAYS_PER_CELL, Refraction, tile_reference};
pub use shafts::{shafts, with_shafts};
pub use tile::{Strength, Tiles, slices};

use std::f64::consts::{PI, TAU};

use imaging::random::Stream;

use super::conditions::Blur;
use super::model::Caustics;

/// Waves of the surface.
const WAVES: usize = 24;
/// The shortest wave, m.
const SHORTEST_M: f64 = 0.15;
/// Gravity, m/s², and the surface tension of water over its density, m³/s².
const GRAVITY: f64 = 9.81;
const TENSION: f64 = 7.4e-5;
/// How wide the disc of the sun is in the water as it blurs a pattern, radians.
const SUN_RAD: f64 = 0.0017;

/// State of the pattern at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waves {
    /// Side of the tile, m.
    pub tile_m: f64,
    /// Cells along it, a power of two.
    pub cells: usize,
    /// Root mean square of the slope.
    pub slope: f64,
    /// Where the wind blows to, radians from the first level axis to the second.
    pub wind: f64,
    /// Seconds.
    pub time_s: f64,
    /// Seed of the waves.
    pub seed: u64,
}

/// One wave: `a cos(k·x − ω t + f)`.
#[derive(Debug, Clone, Copy)]
struct Wave {
    /// Whole waves along both sides of the tile.
    counts: [i32; 2],
    /// k, 1/m.
    vector: [f64; 2],
    /// a, m.
    amplitude: f64,
    /// f − ω t.
    phase: f64,
}

impl Waves {
    /// The waves of a description in the frame with this number.
    #[must_use]
    pub fn new(described: &Caustics, seed: u64, frame: u64) -> Self {
        Self {
            tile_m: described.tile_m,
            cells: described.cells,
            slope: described.slope,
            wind: described.wind_deg.to_radians(),
            time_s: described.fps.map_or(0.0, |fps| frame as f64 / fps),
            seed,
        }
    }

    fn all(&self) -> Vec<Wave> {
        let stream = Stream::stage(self.seed, "caustics");
        let unit = |element: usize| stream.unit(0, element as u64);
        (0..WAVES)
            .map(|j| {
                let longest = self.tile_m / (2.0 * SHORTEST_M);
                let length = SHORTEST_M * longest.powf((j as f64 + 0.5) / WAVES as f64);
                let heading = self.wind + (unit(2 * j) - 0.5) * PI;
                let whole = |share: f64| (self.tile_m * share / length).round() as i32;
                let counts = match [whole(heading.cos()), whole(heading.sin())] {
                    [0, 0] => [1, 0],
                    counts => counts,
                };
                let vector = counts.map(|count| TAU / self.tile_m * f64::from(count));
                let k = vector[0].hypot(vector[1]);
                let turning = (GRAVITY * k + TENSION * k * k * k).sqrt();
                Wave {
                    counts,
                    vector,
                    amplitude: self.slope * (2.0 / WAVES as f64).sqrt() / k,
                    phase: TAU * unit(2 * j + 1) - turning * self.time_s,
                }
            })
            .collect()
    }
}

impl Blur {
    /// M at a depth in meters as a function of the frequency in cycles a meter.
    fn at(&self, depth: f64) -> impl Fn(f64) -> f64 {
        let sharp = (-(self.attenuation - self.spread_attenuation).max(0.0) * depth).exp();
        let wide = (self.wide[0] + self.wide[1] * depth).min(1.0);
        let reach = self
            .angles
            .map(|[at_zero, growth]| TAU * depth * (at_zero + growth * depth));
        let disc = 2.0 * (PI * SUN_RAD * depth).powi(2);
        move |f: f64| {
            let [near, far] = reach.map(|reach| (-reach * f).exp());
            (-disc * f * f).exp() * (sharp + (1.0 - sharp) * ((1.0 - wide) * near + wide * far))
        }
    }
}

#[cfg(test)]
mod tests;
