//! The light of lamps in six waters, on walls and in the water: Monte Carlo against the chain.

mod model;
mod report;

use std::ops::Range;

use optics::lamp::FournierForand;
use truth::light_tracer::{Bench, Shone};
use truth::{Phase, WaterCoefficients};

use model::Model;

pub use report::{csv, markdown};

/// The waters with a and b, 1/m.
pub const WATERS: [(&str, WaterCoefficients); 6] = [
    ("clear", coefficients(0.114, 0.037)),
    ("coastal", coefficients(0.179, 0.219)),
    ("1C", coefficients(0.099, 0.447)),
    ("3C", coefficients(0.118, 0.675)),
    ("5C", coefficients(0.157, 1.267)),
    ("harbor", coefficients(0.366, 1.824)),
];
/// Half angles of the lamps' cones, degrees; `None` for a lamp that shines in all directions.
pub const CONES_DEG: [Option<f64>; 2] = [None, Some(35.0)];
/// The phase functions of the truth.
pub const LAWS: [Law; 2] = [Law::FournierForand, Law::HenyeyGreenstein];
/// b_b/b of all of them.
const BACKSCATTER: f64 = 0.0183;
const WALLS_M: [f64; 3] = [1.0, 2.0, 4.0];
const CAMERAS_M: [f64; 3] = [0.3, 0.5, 1.0];
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
pub enum Law {
    /// That of sea water.
    FournierForand,
    /// That of the chain, which excludes the phase function as a source of its error.
    HenyeyGreenstein,
}

impl Law {
    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::FournierForand => "Fournier-Forand",
            Self::HenyeyGreenstein => "Henyey-Greenstein",
        }
    }

    fn phase(self) -> Phase {
        match self {
            Self::FournierForand => Phase::fournier_forand(FournierForand::of_backscatter(BACKSCATTER)),
            Self::HenyeyGreenstein => Phase::henyey_greenstein(optics::lamp::asymmetry_of(BACKSCATTER)),
        }
    }
}

/// One unit of measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Task {
    /// Which of [`WATERS`].
    pub water: usize,
    /// The lamp's cone.
    pub cone_deg: Option<f64>,
    /// Phase function of the truth.
    pub law: Law,
}

/// Where light was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// On a wall, between two angles at the lamp from its axis, degrees.
    Wall {
        /// Inner and outer angle.
        ring_deg: [f64; 2],
    },
    /// In the water in front of a wall, seen from next to the lamp.
    Water {
        /// Distance of the camera from the lamp, m.
        camera_m: f64,
        /// Angle of its view direction from the lamp's axis, away from it, degrees.
        look_deg: f64,
    },
}

impl Place {
    fn is_wall(self) -> bool {
        matches!(self, Self::Wall { .. })
    }
}

/// A variant of the chain's light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Single scattering with the phase function of Henyey and Greenstein.
    Single,
    /// With multiple scattering.
    Multiple,
    /// The same, with backscatter rising as in the phase function of Fournier and Forand.
    Rising,
}

/// One measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Phase function of the truth.
    pub law: Law,
    /// Which water.
    pub water: &'static str,
    /// Its coefficients.
    pub coefficients: WaterCoefficients,
    /// Whether the lamp is a spot.
    pub is_spot: bool,
    /// Distance of the wall, m.
    pub wall_m: f64,
    /// Where the light was measured.
    pub place: Place,
    /// The light, all orders, and its standard error.
    pub truth: truth::Level,
    /// The light of the chain in each [`Form`].
    pub chain: [f64; 3],
}

impl Cell {
    /// Chain over truth; `None` if the truth is too uncertain.
    #[must_use]
    pub fn ratio(&self, form: Form) -> Option<f64> {
        let is_known = self.truth.mean > 0.0 && self.truth.error <= KNOWN_TO * self.truth.mean;
        is_known.then(|| self.chain[form as usize] / self.truth.mean)
    }
}

/// Measures one lamp in one water.
#[must_use]
pub fn measure(task: Task, photons: Range<u64>) -> Vec<Cell> {
    let Task { water, cone_deg, law } = task;
    let (name, coefficients) = WATERS[water];
    let bench = Bench {
        water: coefficients,
        cone_deg,
        walls_m: WALLS_M.to_vec(),
        looks_deg: if cone_deg.is_some() {
            vec![0.0]
        } else {
            LOOKS_DEG.to_vec()
        },
        cameras_m: CAMERAS_M
            .map(|m| [m * (1.0 - CAMERA_WIDTH), m * (1.0 + CAMERA_WIDTH)])
            .to_vec(),
        rings_deg: RINGS_DEG.to_vec(),
    };
    let shone = bench.shine(&law.phase(), water as u64, photons);
    let model = Model::new(&bench, BACKSCATTER);
    let cell = |wall: usize, place: Place, truth, chain| Cell {
        law,
        water: name,
        coefficients,
        is_spot: cone_deg.is_some(),
        wall_m: WALLS_M[wall],
        place,
        truth,
        chain,
    };
    let mut cells = Vec::new();
    for wall in 0..WALLS_M.len() {
        cells.extend(
            on_wall(&bench, &shone, &model, wall)
                .map(|(place, truth, chain)| cell(wall, place, truth, chain)),
        );
        for (look, &look_deg) in bench.looks_deg.iter().enumerate() {
            for (camera, &camera_m) in CAMERAS_M.iter().enumerate() {
                let chain = model.glow(camera_m, look_deg, WALLS_M[wall]);
                let place = Place::Water { camera_m, look_deg };
                cells.push(cell(wall, place, shone.airlight[look][wall][camera].all, chain));
            }
        }
    }
    cells
}

/// The rings of a wall: scattered and unscattered light.
fn on_wall<'a>(
    bench: &'a Bench,
    shone: &'a Shone,
    model: &'a Model,
    wall: usize,
) -> impl Iterator<Item = (Place, truth::Level, [f64; 3])> + 'a {
    RINGS_DEG.iter().enumerate().map(move |(ring, &outer)| {
        let inner = if ring == 0 { 0.0 } else { RINGS_DEG[ring - 1] };
        let scattered = shone.scattered[wall][ring];
        let chain = model.surface(bench.ring_m(wall, ring), WALLS_M[wall]);
        let truth = truth::Level {
            // The unscattered light is the same in both.
            mean: scattered.mean + chain[0],
            error: scattered.error,
        };
        (
            Place::Wall {
                ring_deg: [inner, outer],
            },
            truth,
            chain,
        )
    })
}
