//! The light of lamps at a point in the water.

use imaging::vector::dot;

use super::Lighting;
use super::patches::{last, mean};

/// Radiance of a white particle that lamps light at a point in camera axes: `I₀ S e^{−c r}/(π r²)`, as a white surface that faces
/// the lamp.
#[must_use]
pub fn white_at(place: [f64; 3], lighting: &Lighting) -> [f64; 3] {
    let range = dot(place, place).sqrt().max(lighting.radius_m);
    let mut sum = [0.0; 3];
    for lamp in &lighting.lamps {
        let away = [0, 1, 2].map(|i| place[i] - lamp.position_m[i]);
        let distance = dot(away, away).sqrt().max(lighting.radius_m);
        let ray = place.map(|v| v / range);
        let murk = mean(lighting.patches.as_ref(), ray, last(range, distance));
        let profile = lamp.beam.profile(|axis| dot(axis, away) / distance);
        for (i, sum) in sum.iter_mut().enumerate() {
            let arriving = (-lighting.attenuation[i] * murk * distance).exp();
            *sum += lamp.intensity[i] * profile * arriving / (std::f64::consts::PI * distance * distance);
        }
    }
    sum
}

/// No [`white_at`] is greater: every lamp at its own surface.
#[must_use]
pub fn most_white(lighting: &Lighting) -> [f64; 3] {
    let nearest = std::f64::consts::PI * lighting.radius_m * lighting.radius_m;
    [0, 1, 2].map(|i| lighting.lamps.iter().map(|lamp| lamp.intensity[i]).sum::<f64>() / nearest)
}
