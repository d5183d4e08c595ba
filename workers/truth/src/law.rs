//! The phase function that a frame asks its truth to have.

use optics::lamp::{AVERAGE_BACKSCATTER_FRACTION, FournierForand, asymmetry_of};
use optics::water::Water;
use serde::Serialize;

use crate::phase::Phase;

/// How the water of a frame scatters in its truth, every number known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "kind")]
pub enum Law {
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

impl Law {
    /// What a description asks for, with the numbers of its water where it gives none.
    #[must_use]
    pub fn asked(asked: spec::Phase, water: Option<&Water>) -> Self {
        let of_water = water.map_or(AVERAGE_BACKSCATTER_FRACTION, Water::backscatter_fraction);
        match asked {
            spec::Phase::Ff { backscatter_fraction } => Self::FournierForand {
                backscatter_fraction: backscatter_fraction.unwrap_or(of_water),
            },
            spec::Phase::Hg { g } => Self::HenyeyGreenstein {
                g: g.unwrap_or_else(|| asymmetry_of(of_water)),
            },
        }
    }

    /// Its phase function.
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
