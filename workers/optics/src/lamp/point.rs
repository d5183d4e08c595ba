//! The light of lamps at a point in the water.

use imaging::vector::dot;

use super::Lighting;
use super::multiple::{blurred, surface_depth, surface_scale};
use super::patches::{last, mean};

/// Radiance of a white particle that lamps light at a point in camera axes: `I₀ S e^{−c r}/(π r²)`, as a white surface that faces
/// the lamp, with what was scattered on the way where that is followed.
#[must_use]
pub fn white_at(place: [f64; 3], lighting: &Lighting) -> [f64; 3] {
    let range = dot(place, place).sqrt().max(lighting.radius_m);
    let mut sum = [0.0; 3];
    for lamp in &lighting.lamps {
        let away = [0, 1, 2].map(|i| place[i] - lamp.position_m[i]);
        let distance = dot(away, away).sqrt().max(lighting.radius_m);
        let ray = place.map(|v| v / range);
        let murk = mean(lighting.patches.as_ref(), ray, last(range, distance));
        let cosine = |axis: [f64; 3]| dot(axis, away) / distance;
        let profile = lamp.beam.profile(cosine);
        for (i, sum) in sum.iter_mut().enumerate() {
            let direct = (-lighting.attenuation[i] * murk * distance).exp();
            let sphere = std::f64::consts::PI * distance * distance;
            *sum += lamp.intensity[i] * profile * direct / sphere;
            if let Some(a) = lighting.absorption {
                let (b, meters) = (lighting.scattering[i], murk * distance);
                let spread = blurred(lamp.beam, surface_scale(b * meters), cosine);
                let all = (-surface_depth(a[i], b, meters)).exp();
                *sum += lamp.intensity[i] * spread * (all - direct).max(0.0) / sphere;
            }
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
