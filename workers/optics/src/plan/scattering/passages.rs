//! How errors of light that passes gates arrive at the camera.
//!
//! At a gate light is divided by the response A of the path to the camera; the light that passes is multiplied by A again. A is a positive
//! kernel of mass `e^{−GZ}`, so the product does not amplify errors. The quotient does: A falls from `e^{−GZ}` to T at high frequencies.
//! But kernels from behind the gate are wide. For any origin θ up to the scale γ₁ at the gate
//!
//! ```text
//! H(γ) / A = [H(γ) / H(θ)] · [H(θ) / A],        |H(θ) / A| ≤ min(1, (T/n)^{θ/γ₁}) / T
//! ```
//!
//! The first factor is interpolated like a kernel of scale γ − θ, which has a known bound; the second is one filter for all of them. With
//! θ = 0 errors are amplified by up to 1/T, with θ = γ₁ by 1/n, but interpolation between kernels of scale γ − γ₁ needs more nodes.

use crate::forward_scatter::Gate;
use crate::layering::Layering;
use crate::water::{Scatter, Water};

/// Rounding of f32 at a gate and in the fill behind it, for light up to 1. With [`levels::rounding`](crate::plan::levels::rounding) it is twice
/// the largest error of 400 frames with a tolerance of 1e-7, for all amplifications.
const ROUNDING: f64 = 5e-7;

/// The gates of one channel of a frame.
pub(crate) struct Passages {
    gates: Vec<Option<Gate>>,
    /// G and c, 1/m.
    spread_attenuation: f64,
    direct_attenuation: f64,
}

/// Path of a layer's light to the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Passage {
    /// No gate in front.
    Open,
    /// Through the gate in front, and those before it.
    Through(Through),
    /// A gate is opaque.
    Closed,
}

/// A gate and the path on from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Through {
    pub(crate) gate: Gate,
    /// Largest response of the path from the gate to the camera.
    onward: f64,
    /// Factor for errors that have the worst sign in every pixel.
    sharpness: f64,
}

impl Passages {
    /// `widest_px` is the widest kernel of the frame.
    pub(crate) fn new(water: &Water, channel: usize, layering: &Layering, widest_px: f64) -> Self {
        let c = water.direct_attenuation[channel];
        let g = match water.scatter {
            Scatter::Jaffe { g, .. } => g[channel].min(c),
            Scatter::None | Scatter::Simplified { .. } => c,
        };
        let gates = layering.gates_m.iter();
        Self {
            gates: gates
                .map(|&range_m| Gate::new(water, channel, range_m, widest_px))
                .collect(),
            spread_attenuation: g,
            direct_attenuation: c,
        }
    }

    /// The path of the light of layer `l`, 0 the nearest.
    pub(crate) fn of_layer(&self, l: usize) -> Passage {
        let Some(front) = l.checked_sub(1) else {
            return Passage::Open;
        };
        let gates: Option<Vec<Gate>> = self.gates[..=front].iter().copied().collect();
        let Some(gates) = gates else {
            return Passage::Closed;
        };
        let gate = gates[front];
        let reverse = gates.windows(2).map(|pair| self.reverse(&pair[0], &pair[1]));
        let mass = (-self.spread_attenuation * gates[0].range_m).exp();
        Passage::Through(Through {
            gate,
            onward: mass * reverse.product::<f64>(),
            sharpness: gates.iter().map(|gate| self.sharpness(gate)).product(),
        })
    }

    /// Sum of the absolute values of a filter in units of its largest response, for quotients by the response of a gate. They fall to
    /// almost 0 around a frequency proportional to (c − G) Z, and ring there.
    fn sharpness(&self, gate: &Gate) -> f64 {
        let amplification = (self.direct_attenuation - self.spread_attenuation) * gate.range_m;
        1.0 - (-amplification).exp_m1() * (0.9 * amplification.sqrt()).max(1.0)
    }

    /// Largest quotient of the responses of a farther and a nearer gate. Gates of close cuts may be in reverse order.
    fn reverse(&self, near: &Gate, far: &Gate) -> f64 {
        (self.direct_attenuation * (near.range_m - far.range_m).max(0.0)).exp()
    }
}

impl Through {
    /// Largest factor of an interpolation error of this layer at the camera. `kernel` is 0 for the narrow and 1 for the wide one,
    /// `share` the origin in units of the kernel's scale at the gate.
    pub(crate) fn gain(&self, kernel: usize, share: f64) -> f64 {
        let ratio = self.gate.ratios()[kernel];
        self.onward * self.sharpness * ratio.powf(-share).min(1.0) / self.gate.direct
    }

    /// Bound of the rounding behind the gate, for light up to `light` in all channels.
    pub(crate) fn rounding(&self, light: f64) -> f64 {
        ROUNDING * light * self.onward
    }
}

#[cfg(test)]
mod tests;
