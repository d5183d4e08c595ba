//! Single scattering in f64, for pixels whose rays pass too close to a lamp for f32.

use std::ops::Range;
use std::sync::LazyLock;

use imaging::Plane;

use super::{Lanes, MOST_NODES};
use crate::lamp::Lighting;
use crate::lamp::reference;
use crate::legendre::gauss_legendre;

/// Rounding of the sum to f32, as a share of it.
const STEP: f64 = 6e-8;
/// Less light than this is lost in f32.
const DARKEST: f64 = f32::MIN_POSITIVE as f64;

/// The rule with the most nodes of any run: its error is at most that of the rule for the tolerance.
static RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss_legendre(MOST_NODES));

/// Sets the light of a run of pixels. Returns its rounding.
pub(super) fn sum_up(
    range: &Plane<f32>,
    lighting: &Lighting,
    (columns, y): (Range<usize>, usize),
    to: &mut [Lanes; 3],
) -> f64 {
    let mut rounding = 0.0f64;
    for (lane, x) in columns.enumerate() {
        let light = reference::light_of_ray((x, y), f64::from(range.pixel(x, y)), lighting, &RULE);
        for (to, light) in to.iter_mut().zip(light) {
            to[lane] = light as f32;
            rounding = rounding.max(STEP * light + DARKEST);
        }
    }
    rounding
}
