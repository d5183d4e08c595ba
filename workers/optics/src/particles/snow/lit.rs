//! Particles in incident light.

use super::Flake;
use super::world::Surround;
use crate::lit_point::LitPoint;

/// A particle as it is seen through the water.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LitFlake {
    /// The particle.
    pub flake: Flake,
    /// Opacity in the middle of its disc, through the water before it.
    pub opacity: [f64; 3],
    /// Radiance of an opaque disc: albedo × light.
    pub color: [f64; 3],
}

/// Particles lit by their surroundings, in their order.
#[must_use]
pub fn lit(flakes: &[Flake], albedo: [f64; 3], surround: &Surround<'_>) -> Vec<LitFlake> {
    let mut lit: Vec<LitFlake> = flakes
        .iter()
        .map(|flake| {
            let path = (surround.path)(flake.place, flake.range_m);
            LitFlake {
                flake: *flake,
                opacity: surround.attenuation.map(|c| flake.opacity * (-c * path).exp()),
                color: [0.0; 3],
            }
        })
        .collect();
    let points = lit.iter().map(|LitFlake { flake, opacity, .. }| LitPoint {
        place: flake.place,
        weight: opacity.iter().copied().fold(0.0, f64::max),
    });
    let light = (surround.light)(&points.collect::<Vec<_>>());
    for (flake, light) in lit.iter_mut().zip(light) {
        flake.color = [0, 1, 2].map(|i| albedo[i] * light[i]);
    }
    lit
}

/// The most light that one of them adds to a pixel.
#[must_use]
pub fn peak(flakes: &[LitFlake]) -> f64 {
    let added =
        |flake: &LitFlake| (0..3).fold(0.0, |most: f64, i| most.max(flake.opacity[i] * flake.color[i]));
    flakes.iter().map(added).fold(0.0, f64::max)
}
