//! Turbidity along the path of lamp light.

use crate::turbidity::Field;

/// The stretch of a ray with most of a lamp's airlight, m from the camera: from `min(Z, t₀) − 3 D/(1 − g)`, where light still needs
/// little deflection toward the camera, to `min(Z, max(t₀, 1.5 D))`, with t₀ along the ray and D across it to the lamp, clamped to
/// the front of the camera. Light from beyond it is scattered at large angles. Found by trial against the field along both legs.
#[must_use]
pub fn glow_within(range_m: f64, nearest_m: f64, distance_m: f64, asymmetry: f64) -> (f64, f64) {
    let from = range_m.min(nearest_m) - before(asymmetry) * distance_m;
    (from.max(0.0), range_m.min(nearest_m.max(BESIDE * distance_m)))
}

/// Start of the airlight before the nearest point and its least reach behind it, in distances of the lamp from the ray.
pub(super) fn before(asymmetry: f64) -> f64 {
    3.0 / (1.0 - asymmetry)
}
pub(super) const BESIDE: f64 = 1.5;

/// The mean of a field between two distances along a unit vector; 1 without a field.
pub(super) fn mean(patches: Option<&Field>, ray: [f64; 3], (from, to): (f64, f64)) -> f64 {
    patches.map_or(1.0, |field| {
        (field.path_m(ray, to) - field.path_m(ray, from)) / (to - from)
    })
}

/// The last stretch of a ray of this length with the length of the path from a lamp, or all of it.
pub(super) fn last(meters: f64, leg: f64) -> (f64, f64) {
    ((meters - leg).max(0.0), meters)
}
