//! Patches of turbid and clear water: a smooth field that multiplies every coefficient along the ray.
//!
//! With K waves of random direction and phase, `m(p) = 1 + k (|Σ e^{i(κ_j·p + φ_j)}|²/K − 1)`, k the contrast within 0..=1 and κ_j
//! of normal components with the standard deviation 1/ℓ, ℓ the scale in meters. It is never negative, its mean is 1, its standard
//! deviation `k √(1 − 1/K)`, and the correlation of two points falls as e^{−r²/ℓ²}; most of the water is somewhat clearer than the
//! mean, some patches are several times as turbid (the statistics of speckle: Goodman 1976). The field is fixed in the world: a
//! moving camera sees the same patches.
//!
//! All coefficients share the factor, so the water of the chain is unchanged once the range Z of each pixel is replaced by the
//! length of the path `τ = ∫₀^Z m dt` through water of the mean. The field is a sum of K (K − 1)/2 cosines, whose integral along a
//! ray is known: `∫₀^Z cos(ψ + q t) dt = Z cos(ψ + q Z/2) sin(q Z/2)/(q Z/2)`. The reference integrates m itself, numerically. For
//! the light of lamps each ray has a separate mean of the field: see [`crate::lamp`].

mod bounds;
mod path;
mod reference;

pub(crate) use bounds::Stretch;
pub use path::optical_path;
pub(crate) use path::{RUN, Rays};
pub use reference::{REFERENCE_STEP, optical_path_reference};

use imaging::random::Stream;
use imaging::vector::dot;
use spec::Turbidity;

use crate::eye::Eye;
use crate::snow::World;

/// Rounding of f32 in a path over less than a hundred scales, as a share of it: the phases of the fastest cosines lose digits.
const PATH_ROUNDING: f64 = 2e-6;

/// Rounding of f32 in a path up to this range, as a share of it; light errs by at most 1/e of that share.
#[must_use]
pub fn path_rounding(farthest_m: f64, scale_m: f64) -> f64 {
    PATH_ROUNDING * (1.0 + farthest_m / (100.0 * scale_m))
}
/// K.
const WAVES: usize = 5;
const PAIRS: usize = WAVES * (WAVES - 1) / 2;

/// One cosine of the field.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Wave {
    /// q, 1/m.
    vector: [f64; 3],
    /// ψ at the origin.
    phase: f64,
}

/// A field in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Field {
    turbidity: Turbidity,
    /// 2 k/K.
    gain: f64,
    pairs: [Wave; PAIRS],
}

impl Field {
    /// The field of one world.
    #[must_use]
    pub fn new(turbidity: &Turbidity, world: World) -> Self {
        let dice = Stream::stage(world.seed, "turbidity");
        let draw = |element: usize| dice.unit(world.index, element as u64);
        let turn = std::f64::consts::TAU;
        // Two uniform numbers for each normal one, after Box and Muller 1958, and one for the phase.
        let waves = [0, 1, 2, 3, 4].map(|j: usize| {
            let first = 7 * j;
            let vector = [0, 2, 4].map(|at| {
                let length = (-2.0 * (1.0 - draw(first + at)).ln()).sqrt();
                length * (turn * draw(first + at + 1)).cos() / turbidity.scale_m
            });
            (vector, turn * draw(first + 6))
        });
        let mut pairs = [Wave::default(); PAIRS];
        let of = (0..WAVES).flat_map(|j| (j + 1..WAVES).map(move |k| (j, k)));
        for (pair, (j, k)) in pairs.iter_mut().zip(of) {
            pair.vector = [0, 1, 2].map(|i| waves[j].0[i] - waves[k].0[i]);
            pair.phase = waves[j].1 - waves[k].1;
        }
        Self {
            turbidity: *turbidity,
            gain: turbidity.contrast * 2.0 / WAVES as f64,
            pairs,
        }
    }

    /// ℓ, m.
    #[must_use]
    pub fn scale_m(&self) -> f64 {
        self.turbidity.scale_m
    }

    /// The least and the greatest m that there may be.
    #[must_use]
    pub fn extremes(&self) -> (f64, f64) {
        let contrast = self.turbidity.contrast;
        (1.0 - contrast, 1.0 + contrast * (WAVES as f64 - 1.0))
    }

    /// m at a point of the world: the factor of every coefficient there.
    #[must_use]
    pub fn factor_at(&self, point: [f64; 3]) -> f64 {
        let sum: f64 = self
            .pairs
            .iter()
            .map(|wave| (dot(wave.vector, point) + wave.phase).cos())
            .sum();
        1.0 + self.gain * sum
    }

    /// The same field in the axes of a camera, its phases those at the camera.
    #[must_use]
    pub fn seen_from(&self, eye: &Eye) -> Self {
        let place = eye.position();
        let pairs = self.pairs.map(|wave| Wave {
            vector: eye.turned(wave.vector),
            phase: (wave.phase + dot(wave.vector, place)) % std::f64::consts::TAU,
        });
        Self { pairs, ..*self }
    }

    /// τ in meters from the origin of the field's axes to a distance along a unit vector, in closed form.
    #[must_use]
    pub fn path_m(&self, direction: [f64; 3], meters: f64) -> f64 {
        self.path_from([0.0; 3], direction, meters)
    }

    /// The same from any point.
    #[must_use]
    pub fn path_from(&self, origin: [f64; 3], direction: [f64; 3], meters: f64) -> f64 {
        let sum: f64 = self
            .pairs
            .iter()
            .map(|wave| {
                let half = 0.5 * meters * dot(wave.vector, direction);
                let share = if half.abs() < 1e-8 { 1.0 } else { half.sin() / half };
                (wave.phase + dot(wave.vector, origin) + half).cos() * share
            })
            .sum();
        meters * (1.0 + self.gain * sum).max(0.0)
    }
}

#[cfg(test)]
mod tests;
