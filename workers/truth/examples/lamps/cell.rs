//! Measurements of lamps in water.

use std::ops::Range;

use optics::lamp::{FournierForand, asymmetry_of};
use truth::light_tracer::Bench;
use truth::{Phase, WaterCoefficients};

use super::model::{BACKSCATTER, Model};

/// The waters with a and b, 1/m.
pub(super) const WATERS: [(&str, WaterCoefficients); 6] = [
    ("clear", coefficients(0.114, 0.037)),
    ("coastal", coefficients(0.179, 0.219)),
    ("1C", coefficients(0.099, 0.447)),
    ("3C", coefficients(0.118, 0.675)),
    ("5C", coefficients(0.157, 1.267)),
    ("harbor", coefficients(0.366, 1.824)),
];
const WALLS_M: [f64; 3] = [1.0, 2.0, 4.0];
const CAMERAS_M: [f64; 3] = [0.3, 0.5, 1.0];
/// Half angle of the cone of a spot, degrees.
const CONE_DEG: f64 = 35.0;
/// Width of a camera's view around its position, as a share of its distance.
const CAMERA_WIDTH: f64 = 0.08;
const RINGS_DEG: [f64; 4] = [10.0, 20.0, 31.0, 45.0];
const LOOKS_DEG: [f64; 5] = [-40.0, -20.0, 0.0, 20.0, 40.0];
/// Maximum relative standard error of the compared cells.
const KNOWN_TO: f64 = 0.1;

const fn coefficients(absorption: f64, scattering: f64) -> WaterCoefficients {
    WaterCoefficients {
        absorption,
        scattering,
    }
}

/// Phase function of the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TruePhase {
    /// That of sea water.
    FournierForand,
    /// That of the chain, which excludes the phase function as a source of its error.
    HenyeyGreenstein,
}

impl TruePhase {
    pub(super) const ALL: [Self; 2] = [Self::FournierForand, Self::HenyeyGreenstein];

    /// Its name in tables.
    pub(super) fn name(self) -> &'static str {
        ["Fournier-Forand", "Henyey-Greenstein"][self as usize]
    }

    fn phase(self) -> Phase {
        match self {
            Self::FournierForand => Phase::fournier_forand(FournierForand::of_backscatter(BACKSCATTER)),
            Self::HenyeyGreenstein => Phase::henyey_greenstein(asymmetry_of(BACKSCATTER)),
        }
    }
}

/// One lamp in one water.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lamp {
    /// Which of [`WATERS`].
    pub(super) water: usize,
    pub(super) is_spot: bool,
    pub(super) phase: TruePhase,
}

/// Where light was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Place {
    /// On a wall, up to this angle at the lamp from its axis and beyond the previous one.
    Wall { ring_deg: f64 },
    /// In the water in front of a wall, by a camera at this distance from the lamp that looks away from its axis by an angle.
    Water { camera_m: f64, look_deg: f64 },
}

/// One measurement.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cell {
    pub(super) lamp: Lamp,
    /// Distance of the wall, m.
    pub(super) wall_m: f64,
    pub(super) place: Place,
    /// The light, all orders, and its standard error.
    pub(super) truth: truth::Level,
    /// The light of the chain with single scattering, with multiple scattering, and with the rising phase function.
    pub(super) chain: [f64; 3],
}

/// Positions in [`Cell::chain`].
pub(super) const SINGLE: usize = 0;
pub(super) const MULTIPLE: usize = 1;
pub(super) const RISING: usize = 2;

impl Cell {
    /// A variant of the chain over the truth; `None` if the truth is too uncertain.
    pub(super) fn ratio(&self, variant: usize) -> Option<f64> {
        let is_known = self.truth.mean > 0.0 && self.truth.error <= KNOWN_TO * self.truth.mean;
        is_known.then(|| self.chain[variant] / self.truth.mean)
    }

    pub(super) fn is_on_wall(&self) -> bool {
        matches!(self.place, Place::Wall { .. })
    }
}

/// Measures one lamp.
pub(super) fn measure(lamp: Lamp, photons: Range<u64>) -> Vec<Cell> {
    let looks_deg = if lamp.is_spot {
        vec![0.0]
    } else {
        LOOKS_DEG.to_vec()
    };
    let bench = Bench {
        water: WATERS[lamp.water].1,
        cone_deg: lamp.is_spot.then_some(CONE_DEG),
        walls_m: WALLS_M.to_vec(),
        looks_deg: looks_deg.clone(),
        cameras_m: CAMERAS_M
            .map(|m| [m * (1.0 - CAMERA_WIDTH), m * (1.0 + CAMERA_WIDTH)])
            .to_vec(),
        rings_deg: RINGS_DEG.to_vec(),
    };
    let shone = bench.shine(&lamp.phase.phase(), lamp.water as u64, photons);
    let model = Model::new(&bench);
    let mut cells = Vec::new();
    for (wall, &wall_m) in WALLS_M.iter().enumerate() {
        for (ring, &ring_deg) in RINGS_DEG.iter().enumerate() {
            let scattered = shone.scattered[wall][ring];
            let chain = model.surface(bench.ring_m(wall, ring), wall_m);
            cells.push(Cell {
                lamp,
                wall_m,
                place: Place::Wall { ring_deg },
                truth: truth::Level {
                    // The unscattered light is the same in both.
                    mean: scattered.mean + chain[SINGLE],
                    error: scattered.error,
                },
                chain,
            });
        }
        for (look, &look_deg) in looks_deg.iter().enumerate() {
            for (camera, &camera_m) in CAMERAS_M.iter().enumerate() {
                cells.push(Cell {
                    lamp,
                    wall_m,
                    place: Place::Water { camera_m, look_deg },
                    truth: shone.airlight[look][wall][camera].all,
                    chain: model.airlight(camera_m, look_deg, wall_m),
                });
            }
        }
    }
    cells
}
