//! Clouds of stirred sediment with edges: banks above the bottom, and plumes behind thrusters.
//!
//! The density ρ of a cloud is within 0..1 and is smooth noise n cut off with a soft edge: `ρ = s(q/w)`, s the smooth step, w the
//! width of an edge. For banks `q = n + σ Φ⁻¹(cover) − 2.2 σ (h/H)²` at the height h above the bottom, σ the standard deviation of
//! n: banks cover the share `cover` of the bottom, and almost vanish above H. A plume is a turbulent jet, a cone that widens by a
//! fifth of its length (half angle 11.8°; Pope 2000), `q = 1 + 1.5 n − (r/R)² − (s/L)²` at the length s along its axis and the
//! distance r from it. Noise is fixed in the world; thrusters move with the camera.
//!
//! A length dt of a cloud absorbs the share `ε ρ dt` of the light behind it and adds albedo × light, both seen through the water
//! before it like particles of [`crate::snow`]: `I ← I (1 − α) + C α`, `α = (1 − e^{−ε ρ dt}) e^{−c t}`. Light is that of lamps and
//! daylight at its position; shadows between parts of a cloud are ignored.

mod drift;
mod fast;
mod noise;
mod reference;

pub use fast::{Layers, layers};
pub use reference::veil_reference;

use imaging::Plane;
use imaging::random::Stream;
use imaging::vector::dot;
use spec::{Sediment, normal_quantile};

use crate::eye::Eye;
use crate::lit_point::LitPoint;
use crate::range::is_hole;
use crate::snow::{WhiteLight, World};

use noise::Noise;

/// Standard deviation of the noise.
const SPREAD: f64 = 0.28;
/// Thinning of banks at their height, standard deviations.
const RISE: f64 = 2.2;
/// How fast a jet widens (Pope 2000, section 5.1).
const WIDENING: f64 = 0.2;
/// Radius of a thruster, m.
const NOZZLE_M: f64 = 0.05;
/// Clouds are rendered up to here, m.
pub const FAR_M: f64 = 15.0;
/// Height of a picture's camera above the bottom if it is not given, m.
const ABOVE_M: f64 = 1.5;
/// Length of a plume, m.
const PLUME_M: f64 = 1.5;

/// A plume in camera axes.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Plume {
    from: [f64; 3],
    axis: [f64; 3],
}

/// The clouds before a camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Clouds {
    law: Sediment,
    eye: Eye,
    up: [f64; 3],
    /// Height of the camera above the bottom, m.
    above: f64,
    noise: Noise,
    plumes: Vec<Plume>,
}

/// The water around clouds.
#[derive(Clone, Copy)]
pub struct Murk<'a> {
    /// Beam attenuation c, 1/m.
    pub attenuation: [f64; 3],
    /// Meters of water of this attenuation up to a point in camera axes at this range.
    pub path: &'a dyn Fn([f64; 3], f64) -> f64,
    /// Radiance of a white particle at each of some points in camera axes.
    pub light: WhiteLight<'a>,
}

impl Clouds {
    /// The clouds of a world before a camera; `up` is against gravity in its axes. A camera without a world has the
    /// bottom of the description under it.
    #[must_use]
    pub fn new(law: &Sediment, world: World, eye: &Eye, up: [f64; 3], knows_bottom: bool) -> Self {
        let dice = Stream::stage(world.seed, "sediment");
        let above = if knows_bottom {
            eye.position()[2]
        } else {
            law.above_bottom_m.unwrap_or(ABOVE_M)
        };
        let plume = |number: usize| {
            let draw = |choice: u64| dice.unit(world.index, 16 + 8 * number as u64 + choice);
            // To the side of and below the camera, ahead and outwards.
            let (sin, cos) = (std::f64::consts::PI * (0.08 + 0.84 * draw(0))).sin_cos();
            let aside = 0.3 + 0.5 * draw(1);
            let axis = [
                cos * (0.1 + 0.5 * draw(2)),
                0.15 + 0.35 * draw(3),
                0.5 + 0.5 * draw(4),
            ];
            let length = dot(axis, axis).sqrt();
            Plume {
                from: [aside * cos, 0.6 * aside * sin, 0.2 + 0.5 * draw(5)],
                axis: axis.map(|v| v / length),
            }
        };
        Self {
            law: *law,
            eye: *eye,
            up,
            above,
            noise: Noise::new(dice.bits(world.index, 0)),
            plumes: (0..law.thrusters).map(plume).collect(),
        }
    }

    /// The same clouds if the thrusters are described in the axes of a camera this many meters to the left.
    #[must_use]
    pub fn seen_from_right(mut self, right_m: f64) -> Self {
        for plume in &mut self.plumes {
            plume.from[0] -= right_m;
        }
        self
    }

    /// ρ at a point in camera axes.
    #[must_use]
    pub fn density(&self, place: [f64; 3]) -> f64 {
        let height = self.above + dot(self.up, place);
        if height < -0.5 {
            return 0.0;
        }
        let world = self.eye.to_world(place).map(|v| v / self.law.scale_m);
        // Of the banks: the noise left at their height, and whether there is any.
        let rise = (height.max(0.0) / self.law.height_m).powi(2);
        let lift = if self.law.cover > 0.0 {
            SPREAD * (self.cut() - RISE * rise)
        } else {
            f64::NEG_INFINITY
        };
        let near = self.plumes.iter().map(|plume| self.jet(plume, place));
        let jet = near.fold(f64::NEG_INFINITY, f64::max);
        if lift < -MOST && jet < -1.5 * MOST {
            return 0.0;
        }
        let noise = self.noise.at(world);
        smooth((noise + lift).max(jet + 1.5 * noise) / self.law.edge)
    }

    /// The light of white clouds at some points times their albedo.
    fn colors(&self, murk: &Murk<'_>, points: &[LitPoint]) -> Vec<[f64; 3]> {
        let mut colors = (murk.light)(points);
        for color in &mut colors {
            *color = [0, 1, 2].map(|i| self.law.albedo[i] * color[i]);
        }
        colors
    }

    /// The share of the light that a cloud sends back.
    #[must_use]
    pub fn albedo(&self) -> [f64; 3] {
        self.law.albedo
    }

    /// Upper bound of the opacity of pixels with these ranges: 0 without clouds, or if all visible surfaces are above the banks.
    #[must_use]
    pub fn most_opacity(&self, range: &Plane<f32>) -> f64 {
        let is_met = !self.plumes.is_empty() || (self.law.cover > 0.0 && self.shows_banks(range));
        if !is_met {
            return 0.0;
        }
        let farthest = range.data().iter().map(|&z| end(z)).fold(0.0, f64::max);
        -(-self.law.extinction_per_m * farthest).exp_m1()
    }

    /// Whether any pixel shows a point below the greatest height of banks.
    fn shows_banks(&self, range: &Plane<f32>) -> bool {
        let (width, height) = range.size();
        let top = self.law.height_m * ((self.cut() + MOST / SPREAD) / RISE).max(0.0).sqrt();
        let lowest = |x: usize, y: usize| {
            let ray = self.eye.ray(x as f64, y as f64);
            self.above + (dot(self.up, ray) * end(range.pixel(x, y))).min(0.0)
        };
        // The lower rows first, where the bottom mostly is.
        (0..height).rev().any(|y| (0..width).any(|x| lowest(x, y) <= top))
    }

    /// Standard deviations added to the noise at the bottom, so that banks cover their share of it.
    fn cut(&self) -> f64 {
        normal_quantile(self.law.cover.clamp(1e-4, 1.0 - 1e-4))
    }

    /// `1 − (r/R)² − (s/L)²` of a plume.
    fn jet(&self, plume: &Plume, place: [f64; 3]) -> f64 {
        let away = [0, 1, 2].map(|i| place[i] - plume.from[i]);
        let along = dot(away, plume.axis);
        if along <= 0.0 {
            return f64::NEG_INFINITY;
        }
        let aside = (dot(away, away) - along * along).max(0.0);
        let wide = NOZZLE_M + WIDENING * along;
        1.0 - aside / (wide * wide) - (along / PLUME_M).powi(2)
    }
}

/// Upper bound of the noise.
const MOST: f64 = 1.0;

/// Distance up to which a pixel shows clouds, m; limited at a hole.
fn end(range: f32) -> f64 {
    if is_hole(range) {
        FAR_M
    } else {
        f64::from(range).min(FAR_M)
    }
}

fn smooth(share: f64) -> f64 {
    let share = share.clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

/// A cloud on a slice of a ray.
pub(crate) struct Drift {
    pub(crate) slice: usize,
    pub(crate) place: [f64; 3],
    /// From the camera, m.
    pub(crate) range_m: f64,
    /// The share of the light that it stops.
    pub(crate) stopped: f64,
}

#[cfg(test)]
mod tests;
