//! The share of light that a phase function scatters within an angle.

use spec::PhaseFunction;

use crate::lamp::{FournierForand, asymmetry_of};

/// A phase function by the share of light within an angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum CumulativePhase {
    /// Henyey and Greenstein 1941.
    HenyeyGreenstein {
        /// Mean cosine.
        asymmetry: f64,
    },
    /// Fournier and Forand.
    FournierForand(FournierForand),
}

impl CumulativePhase {
    /// That of water with this b_b/b.
    #[must_use]
    pub(super) fn new(phase: PhaseFunction, backscatter_fraction: f64) -> Self {
        match phase {
            PhaseFunction::Hg => Self::HenyeyGreenstein {
                asymmetry: asymmetry_of(backscatter_fraction),
            },
            PhaseFunction::Ff => Self::FournierForand(FournierForand::of_backscatter(backscatter_fraction)),
        }
    }

    /// The share of light scattered within an angle of `1 − cos = v`.
    #[must_use]
    pub(super) fn within(&self, v: f64) -> f64 {
        match self {
            Self::HenyeyGreenstein { asymmetry: g } => {
                let s = ((1.0 - g) * (1.0 - g) + 2.0 * g * v).sqrt();
                (1.0 + g) * v / ((s + 1.0 - g) * s)
            }
            Self::FournierForand(particles) => particles.within(v),
        }
    }
}
