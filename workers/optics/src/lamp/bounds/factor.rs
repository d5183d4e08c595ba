//! Bounds of the factor that patches of turbidity put on the coefficients of the water.

use super::super::Lighting;
use super::super::patches::{BESIDE, before};
use super::STEP;
use super::cone::{Cone, Passing};
use crate::turbidity::{self, Stretch};

/// Means of the factor over stretches of the rays of a cone.
#[derive(Clone, Copy)]
pub(super) struct Factor {
    /// Least and greatest mean.
    pub(super) bounds: [f64; 2],
    /// Largest relative error in f32 of a mean over a path that begins at the camera.
    error: f64,
    /// How many times as long two of these are together as the stretch between their ends.
    lengths: f64,
}

impl Factor {
    const EVEN: Self = Self {
        bounds: [1.0; 2],
        error: 0.0,
        lengths: 1.0,
    };

    /// On the path from a lamp to surfaces between two ranges: for the same length of the ray before them.
    pub(super) fn to_surfaces(lighting: &Lighting, cone: Cone, passing: &Passing, range_m: [f64; 2]) -> Self {
        let legs = passing.distances(range_m);
        let from_m = [range_m[0] - legs[1], range_m[1] - legs[0]].map(|from| from.max(0.0));
        Self::new(lighting, cone, [from_m, range_m], legs[0].min(range_m[0]))
    }

    /// On the path of airlight, and at its scattering, along rays that end between two ranges.
    pub(super) fn of_airlight(
        lighting: &Lighting,
        cone: Cone,
        passing: &Passing,
        range_m: [f64; 2],
    ) -> [Self; 2] {
        let (nearest, beside) = (passing.nearest_m(), [passing.beside_m(), passing.most_beside_m()]);
        let before = before(lighting.phase.asymmetry);
        let to_m = [0, 1].map(|i| range_m[i].min(nearest[i].max(BESIDE * beside[i])));
        let from_m = [0, 1].map(|i| (range_m[i].min(nearest[i]) - before * beside[1 - i]).max(0.0));
        let shortest = to_m[0].min(before * beside[0]);
        [
            Self::new(lighting, cone, [[0.0; 2], to_m], to_m[0]),
            Self::new(lighting, cone, [from_m, to_m], shortest),
        ]
    }

    /// For stretches of at least `shortest`, m.
    fn new(lighting: &Lighting, cone: Cone, [from_m, to_m]: [[f64; 2]; 2], shortest: f64) -> Self {
        let Some(field) = &lighting.patches else {
            return Self::EVEN;
        };
        let bounds = field.bound_mean(&Stretch {
            ray: cone.center,
            turned: cone.chord(),
            from_m,
            to_m,
        });
        // Errors of a mean grow with the contrast.
        let error = field.contrast() * turbidity::path_rounding(to_m[1], field.scale_m()) + 3.0 * STEP;
        Self {
            bounds,
            error: error * (1.0 / bounds[0].max(1e-3)).max(1.0),
            lengths: (to_m[1] + from_m[1]) / shortest.max(to_m[0] - from_m[1]),
        }
    }

    /// Largest relative error of a mean in f32.
    pub(super) fn error(&self) -> f64 {
        self.error * self.lengths.max(1.0)
    }

    /// The same of surfaces that are `seen` times as far from the camera as from the lamp at most.
    pub(super) fn error_to(&self, seen: f64) -> f64 {
        self.error * (2.0 * seen - 1.0).max(1.0)
    }
}
