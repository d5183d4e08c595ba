//! Test solids, and means over paths.

use imaging::random::Stream;
use imaging::rays::{Hit, Rays};
use imaging::vector::{DVec3, vec3};
use truth::{Address, Along, ORDERS, Phase, SphereLamp, SurfaceMaterials, TracedScene, WaterCoefficients};

/// A surface; its index among the solids selects its material.
pub(crate) enum TestSolid {
    /// The unbounded plane z = this.
    Wall(f64),
    /// The part of the plane z = `z` with |x| up to `half`.
    Plate { z: f64, half: f64 },
    /// A box, from outside or inside.
    Block { low: [f64; 3], high: [f64; 3] },
}

pub(crate) struct Solids(pub(crate) Vec<TestSolid>);

impl TestSolid {
    fn enter(&self, origin: [f64; 3], direction: [f64; 3], from: f64) -> Option<(f64, [f64; 3])> {
        let facing = |axis: usize| {
            let mut normal = [0.0; 3];
            normal[axis] = -direction[axis].signum();
            normal
        };
        match *self {
            Self::Wall(z) => Some(((z - origin[2]) / direction[2], facing(2))),
            Self::Plate { z, half } => {
                let distance = (z - origin[2]) / direction[2];
                ((origin[0] + distance * direction[0]).abs() <= half).then(|| (distance, facing(2)))
            }
            Self::Block { low, high } => {
                let (mut enter, mut leave) = ((f64::NEG_INFINITY, 0), (f64::INFINITY, 0));
                for axis in 0..3 {
                    let parameter = |place: f64| (place - origin[axis]) / direction[axis];
                    let (a, b) = (parameter(low[axis]), parameter(high[axis]));
                    if a.min(b) > enter.0 {
                        enter = (a.min(b), axis);
                    }
                    if a.max(b) < leave.0 {
                        leave = (a.max(b), axis);
                    }
                }
                if enter.0 > leave.0 {
                    return None;
                }
                let (distance, axis) = if enter.0 >= from { enter } else { leave };
                Some((distance, facing(axis)))
            }
        }
    }
}

impl Rays for Solids {
    fn hit(&self, origin: [f64; 3], direction: [f64; 3], from: f64, to: f64) -> Option<Hit> {
        let met = self.0.iter().enumerate().filter_map(|(object, solid)| {
            let (distance, normal) = solid.enter(origin, direction, from)?;
            (distance >= from && distance <= to).then_some(Hit {
                distance,
                normal,
                object: object as u32,
            })
        });
        met.min_by(|a, b| a.distance.total_cmp(&b.distance))
    }
}

/// A scene without lamps and sea.
pub(crate) fn scene<'a>(
    solids: &'a Solids,
    surfaces: Vec<truth::Lambertian>,
    water: WaterCoefficients,
    phase: Phase,
) -> TracedScene<'a> {
    TracedScene {
        rays: solids,
        surfaces: SurfaceMaterials::ByObject(surfaces),
        lamps: Vec::new(),
        sea: None,
        water: [water; 3],
        phase,
        turbidity: truth::TurbidityField::Even,
    }
}

/// An isotropic lamp of 2 cm.
pub(crate) fn lamp(place: [f64; 3], intensity: f64) -> SphereLamp {
    SphereLamp {
        place: place.into(),
        intensity: [intensity; 3],
        beam: None,
        radius_m: 0.02,
        disc_m: 0.0,
    }
}

pub(crate) fn water(absorption: f64, scattering: f64) -> WaterCoefficients {
    WaterCoefficients {
        absorption,
        scattering,
    }
}

pub(crate) fn along(direction: [f64; 3]) -> Along {
    Along {
        origin: vec3(0.0, 0.0, 0.0),
        direction: DVec3::from(direction).normalized(),
    }
}

/// A mean and its standard error.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mean {
    pub(crate) mean: f64,
    pub(crate) error: f64,
}

impl Mean {
    pub(crate) fn from_batches(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let square = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
        Self {
            mean,
            error: (square / (n * (n - 1.0))).sqrt(),
        }
    }

    #[track_caller]
    pub(crate) fn agrees(self, expected: f64, error: f64, what: &str) {
        let allowed = 4.0 * self.error.hypot(error) + 1e-12;
        assert!(
            (self.mean - expected).abs() <= allowed,
            "{what}: {self:?}, expected {expected} ± {error}"
        );
    }
}

/// Radiance of the first channel along a ray by scattering order, followed by the total.
pub(crate) fn radiance(scene: &TracedScene<'_>, along: Along, pixel: u64, paths: u64) -> [Mean; ORDERS + 1] {
    let stream: Stream = truth::stream(7);
    const BATCHES: usize = 32;
    let mut sums = [[0.0; BATCHES]; ORDERS + 1];
    let share = BATCHES as f64 / paths as f64;
    for sample in 0..paths {
        let address = Address {
            frame: 0,
            pixel,
            sample,
            channel: 0,
        };
        let tally = scene.trace(along, stream, address);
        assert!(!tally.is_cut);
        let batch = sample as usize % BATCHES;
        for (order, [light]) in tally.orders.into_iter().enumerate() {
            sums[order][batch] += share * light;
            sums[ORDERS][batch] += share * light;
        }
    }
    sums.map(|batches| Mean::from_batches(&batches))
}
