//! Lamps in f64 with many nodes. It shares nothing with the fast form but the definitions.

use imaging::geometry::Intrinsics;
use imaging::vector::dot;
use imaging::{Plane, Rgb};

use super::beam::Beam;
use super::patches::{glow_within, last, mean};
use super::{Lamp, Lighting, henyey_greenstein};
use crate::legendre::gauss_legendre;
use crate::range::is_hole;

/// Nodes with which the reference is exact to 1e-9 of a lamp's peak for g up to 0.98.
pub const REFERENCE_NODES: usize = 128;

/// The glow of the water before the lamps, radiance in linear light: for a ray along the unit vector d up to the range Z (a hole:
/// without end), with t₀ = d·P and D the distance of the lamp from the ray,
/// `L = (b I₀/D) ∫ S p(−sin θ) e^{−c (t₀ + D tan θ + D/cos θ)} dθ` from `atan(−t₀/D)` to `atan((Z − t₀)/D)`,
/// by Gauss–Legendre quadrature with `nodes` nodes; in patchy water b and c are those of the ray, see [`glow_within`] (single scattering: Sun et al. 2005, Eq. 7-10).
#[must_use]
pub fn airlight_reference(range: &Plane<f64>, lighting: &Lighting, nodes: usize) -> Rgb<f64> {
    let rule = gauss_legendre(nodes);
    Rgb::from_fn(range.width(), range.height(), |x, y| {
        let (ray, z) = (direction(&lighting.camera, x, y), range.pixel(x, y));
        let z = if is_hole(z) { f64::INFINITY } else { z };
        let mut sum = [0.0; 3];
        for lamp in &lighting.lamps {
            let glow = glow(ray, z, lamp, lighting, &rule);
            sum.iter_mut().zip(glow).for_each(|(sum, glow)| *sum += glow);
        }
        sum
    })
}

fn glow(ray: [f64; 3], z: f64, lamp: &Lamp, lighting: &Lighting, rule: &[(f64, f64)]) -> [f64; 3] {
    let place = lamp.position_m;
    let nearest = dot(ray, place);
    let offset = [0, 1, 2].map(|i| nearest * ray[i] - place[i]);
    let distance = dot(offset, offset).sqrt().max(lighting.radius_m);
    let mut from = (-nearest / distance).atan();
    let mut to = ((z - nearest) / distance).atan();
    let cosine = |theta: f64, axis: [f64; 3]| {
        theta.cos() * dot(axis, offset) / distance + theta.sin() * dot(axis, ray)
    };
    if let Beam::Spot { axis, cos_cone } = lamp.beam {
        // Within the cone: where M cos(θ − φ) exceeds cos cone. Outside the quadrature would meet an edge.
        let (across, along) = (dot(axis, offset) / distance, dot(axis, ray));
        let (most, middle) = (across.hypot(along), along.atan2(across));
        if most <= cos_cone {
            return [0.0; 3];
        }
        let half = (cos_cone / most).acos();
        (from, to) = (from.max(middle - half), to.min(middle + half));
    }
    let patches = lighting.patches.as_ref();
    let (begin, end) = glow_within(z, nearest, distance, lighting.asymmetry);
    let (source, murk) = (mean(patches, ray, (begin, end)), mean(patches, ray, (0.0, end)));
    let mut sum = [0.0; 3];
    for (node, weight) in rule.iter().filter(|_| to > from) {
        let theta = 0.5 * (from + to) + 0.5 * (to - from) * node;
        let profile = lamp.beam.profile(|axis| cosine(theta, axis));
        let path = nearest + distance * (theta.tan() + 1.0 / theta.cos());
        let scattered = weight * profile * henyey_greenstein(lighting.asymmetry, -theta.sin());
        for (sum, c) in sum.iter_mut().zip(lighting.attenuation) {
            *sum += scattered * (-c * murk * path).exp();
        }
    }
    [0, 1, 2].map(|i| {
        source * lighting.scattering[i] * lamp.intensity[i] / distance * 0.5 * (to - from).max(0.0) * sum[i]
    })
}

/// The light of the lamps that falls on surfaces: `E = I₀ S e^{−c r} max(n·l, 0) / r²`, none at a hole. `normals` are unit
/// vectors in camera axes.
#[must_use]
pub fn irradiance_reference(range: &Plane<f64>, normals: &[Plane<f32>; 3], lighting: &Lighting) -> Rgb<f64> {
    Rgb::from_fn(range.width(), range.height(), |x, y| {
        let (ray, z) = (direction(&lighting.camera, x, y), range.pixel(x, y));
        let normal = [0, 1, 2].map(|i| f64::from(normals[i].pixel(x, y)));
        let mut sum = [0.0; 3];
        for lamp in lighting.lamps.iter().filter(|_| !is_hole(z)) {
            let to_lamp = [0, 1, 2].map(|i| lamp.position_m[i] - z * ray[i]);
            let distance = dot(to_lamp, to_lamp).sqrt().max(lighting.radius_m);
            let facing = dot(normal, to_lamp).max(0.0) / distance;
            let profile = lamp.beam.profile(|axis| -dot(axis, to_lamp) / distance);
            let fall = facing * profile / (distance * distance);
            let meters = mean(lighting.patches.as_ref(), ray, last(z, distance)) * distance;
            for i in 0..3 {
                sum[i] += lamp.intensity[i] * fall * (-lighting.attenuation[i] * meters).exp();
            }
        }
        sum
    })
}

/// The unit vector along the ray of a pixel.
fn direction(camera: &Intrinsics, x: usize, y: usize) -> [f64; 3] {
    let ray: [f64; 3] = camera.ray(x as f64, y as f64).into();
    let length = dot(ray, ray).sqrt();
    ray.map(|v| v / length)
}
