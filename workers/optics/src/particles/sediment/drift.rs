//! Clouds on the slices of a ray.

use super::{Clouds, Drift, Murk};
use crate::lit_point::LitPoint;

impl Drift {
    /// The clouds in the middles of the slices of a ray, each `step` meters long.
    pub(super) fn along(
        clouds: &Clouds,
        ray: [f64; 3],
        slices: usize,
        step: f64,
    ) -> impl Iterator<Item = Self> {
        (0..slices).filter_map(move |slice| {
            let range_m = (slice as f64 + 0.5) * step;
            let place = ray.map(|v| v * range_m);
            let density = clouds.density(place);
            (density > 0.0).then(|| Self {
                slice,
                place,
                range_m,
                stopped: -(-clouds.law.extinction_per_m * density * step).exp_m1(),
            })
        })
    }

    /// Where it is lit.
    pub(super) fn point(&self, weight: f64) -> LitPoint {
        LitPoint {
            place: self.place,
            weight,
        }
    }

    /// Transmittance of the water before it.
    pub(super) fn through(&self, murk: &Murk<'_>) -> [f64; 3] {
        let path = (murk.path)(self.place, self.range_m);
        murk.attenuation.map(|c| (-c * path).exp())
    }
}
