//! Paths through the field in f64 by quadrature. It shares only the field with the fast form.

use imaging::Plane;
use spec::{HoleRule, Turbidity};

use super::Field;
use crate::eye::Eye;
use crate::legendre::gauss_legendre;
use crate::range::{SHORTEST_M, is_hole};

/// Panels of the quadrature are this share of the scale at most.
pub const REFERENCE_STEP: f64 = 0.5;
/// Nodes of a panel: over half a scale the fastest cosine turns by a few radians, which 12 nodes integrate to 1e-12.
const NODES: usize = 12;
/// More panels would not end.
const MOST_PANELS: f64 = 1e5;

/// `τ = ∫₀^Z m dt` of every pixel in meters, at least a millimeter: Gauss–Legendre quadrature with 12 nodes on panels of half a
/// scale. Holes stay holes, unless the rule replaces them by a range.
#[must_use]
pub fn optical_path_reference(
    range: &Plane<f64>,
    turbidity: &Turbidity,
    field: &Field,
    eye: &Eye,
    holes: HoleRule,
) -> Plane<f64> {
    let rule = gauss_legendre(NODES);
    Plane::from_fn(range.width(), range.height(), |x, y| {
        let z = match holes {
            HoleRule::RangeM(meters) if is_hole(range.pixel(x, y)) => meters,
            _ => range.pixel(x, y),
        };
        if is_hole(z) {
            return z;
        }
        let ray = eye.ray(x as f64, y as f64);
        let panels = (z / (REFERENCE_STEP * turbidity.scale_m))
            .ceil()
            .clamp(1.0, MOST_PANELS);
        let half = 0.5 * z / panels;
        let panel = |panel: usize| {
            let middle = half * (2.0 * panel as f64 + 1.0);
            let nodes = rule.iter().map(|(node, weight)| {
                let t = middle + half * node;
                weight * field.factor_at(eye.to_world(ray.map(|v| t * v)))
            });
            half * nodes.sum::<f64>()
        };
        (0..panels as usize).map(panel).sum::<f64>().max(SHORTEST_M)
    })
}
