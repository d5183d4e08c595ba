//! The gate between two layers, in numbers.
//!
//! The path from the range G of a gate has the response `A = T + n H(γ₁) + v H(γ₂)`, `n = w (1−m)`, `v = w m`. Light from behind is divided
//! by A, so each of its kernels acts as `H(γ) / A`. For γ ≥ γ₁ that is at most 1/max(n, T), although A falls to T at high frequencies.
//! Light in units of max(n, T) therefore stays of order 1 on both sides of the division.

use super::widest_px;
use crate::kernel::GateReach;
use crate::water::{Arrival, Water};

/// A gate at more attenuation lengths than this is opaque.
pub(crate) const OPAQUE_GATE: f64 = 20.0;

/// Response of the path from a gate to the camera, in one channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Gate {
    /// Its range, meters.
    pub(crate) range_m: f64,
    /// T, the direct transmittance.
    pub(crate) direct: f64,
    /// n and v, the shares that the narrow and the wide kernel spread.
    pub(crate) spread: [f64; 2],
    /// γ₁ and γ₂, pixels.
    pub(crate) gammas: [f64; 2],
}

impl Gate {
    /// A gate of a frame whose widest kernel has the scale `widest_px`; `None` if it is opaque.
    pub(crate) fn new(water: &Water, channel: usize, range_m: f64, widest_px: f64) -> Option<Self> {
        if water.direct_attenuation[channel] * range_m > OPAQUE_GATE {
            return None;
        }
        let Arrival {
            direct,
            spread,
            gammas,
            wide,
        } = water.arrival(channel, range_m, widest_px)?;
        Some(Self {
            range_m,
            direct,
            spread: [spread * (1.0 - wide), spread * wide],
            gammas,
        })
    }

    /// The same of a frame of this size.
    pub(super) fn in_frame(
        water: &Water,
        channel: usize,
        range_m: f64,
        (width, height): (usize, usize),
    ) -> Option<Self> {
        Self::new(water, channel, range_m, widest_px(width, height))
    }

    /// n/T and v/T.
    pub(crate) fn ratios(&self) -> [f64; 2] {
        self.spread.map(|spread| spread / self.direct)
    }

    /// max(n, T) and max(v, T), the units of the light of each kernel.
    pub(super) fn units(&self) -> [f64; 2] {
        self.spread.map(|spread| spread.max(self.direct))
    }

    /// Reach of the narrow and of the wide kernels behind the gate.
    pub(super) fn reaches(&self) -> [GateReach; 2] {
        let ratios = self.ratios();
        [0, 1].map(|part| GateReach {
            amplification: ratios[part].max(1.0).ln(),
            gamma_px: self.gammas[part],
        })
    }
}
