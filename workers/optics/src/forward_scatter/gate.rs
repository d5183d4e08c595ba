//! The gate between two layers, in numbers.
//!
//! Light at the range G of a gate arrives under `A = T + n H(γ₁) + v H(γ₂)`, `n = w (1−m)`, `v = w m`. What is behind is divided by it, so
//! that of a layer's kernels `H(γ) / A` counts. For γ ≥ γ₁ that is at most 1/max(n, T), although A falls to T at high frequencies: light is
//! carried in these units, and nothing is small that a division makes large again.

use super::widest_px;
use crate::kernel::GateReach;
use crate::water::{Arrival, Water};

/// Nothing passes a gate behind which the beam has this many attenuation lengths.
pub(crate) const OPAQUE_GATE: f64 = 20.0;

/// What becomes of the light of one channel between a gate and the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Gate {
    /// Its range, meters.
    pub(crate) range_m: f64,
    /// T, what keeps its ray.
    pub(crate) direct: f64,
    /// n and v, what the narrow and the wide kernel spread.
    pub(crate) spread: [f64; 2],
    /// γ₁ and γ₂, pixels.
    pub(crate) gammas: [f64; 2],
}

impl Gate {
    /// A gate of a frame whose widest kernel is of scale `widest_px`; none where nothing passes.
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

    /// max(n, T) and max(v, T), the units of light that each kernel spreads.
    pub(super) fn units(&self) -> [f64; 2] {
        self.spread.map(|spread| spread.max(self.direct))
    }

    /// Where kernels behind the gate count, of narrow and of wide ones.
    pub(super) fn reaches(&self) -> [GateReach; 2] {
        let ratios = self.ratios();
        [0, 1].map(|part| GateReach {
            amplification: ratios[part].max(1.0).ln(),
            gamma_px: self.gammas[part],
        })
    }
}
