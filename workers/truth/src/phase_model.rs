//! The described phase function of a frame.

use optics::lamp::{AVERAGE_BACKSCATTER_FRACTION, FournierForand, asymmetry_of};
use optics::water::Water;
use serde::Serialize;
use spec::PhaseFunction;

use crate::phase::Phase;

/// Phase function with all parameters.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "kind")]
pub enum PhaseModel {
    /// Fournier–Forand on the line of Mobley, Sundman and Boss.
    #[serde(rename = "ff")]
    FournierForand {
        /// b_b/b.
        backscatter_fraction: f64,
    },
    /// Henyey–Greenstein.
    #[serde(rename = "hg")]
    HenyeyGreenstein {
        /// Mean cosine.
        g: f64,
    },
}

impl PhaseModel {
    /// The phase function of a description, with the backscatter fraction of its water.
    #[must_use]
    pub fn of_water(phase: PhaseFunction, water: Option<&Water>) -> Self {
        let backscatter_fraction = water.map_or(AVERAGE_BACKSCATTER_FRACTION, Water::backscatter_fraction);
        match phase {
            PhaseFunction::Ff => Self::FournierForand { backscatter_fraction },
            PhaseFunction::Hg => Self::HenyeyGreenstein {
                g: asymmetry_of(backscatter_fraction),
            },
        }
    }

    /// Its table.
    #[must_use]
    pub fn phase(self) -> Phase {
        match self {
            Self::FournierForand { backscatter_fraction } => {
                Phase::fournier_forand(FournierForand::of_backscatter(backscatter_fraction))
            }
            Self::HenyeyGreenstein { g } => Phase::henyey_greenstein(g),
        }
    }
}
