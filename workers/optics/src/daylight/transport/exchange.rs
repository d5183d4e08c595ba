//! Scattering between the directions of a quadrature.

use std::f64::consts::{PI, TAU};

use super::super::aureole::ForwardPeak;
use super::super::wide::WideScattering;
use crate::daylight::model::{CRITICAL_COSINE, fresnel};
use crate::legendre::gauss_legendre;

/// Directions between the nadir, the mirrored critical angle, the horizon, the critical angle and the zenith.
const SPLIT: [(f64, f64, usize); 4] = [
    (-1.0, -CRITICAL_COSINE, 6),
    (-CRITICAL_COSINE, 0.0, 6),
    (0.0, CRITICAL_COSINE, 8),
    (CRITICAL_COSINE, 1.0, 8),
];
/// Number of directions.
pub(in crate::daylight) const DIRECTIONS: usize = 28;
/// The first that looks up.
pub(in crate::daylight) const FIRST_UP: usize = 12;
const AZIMUTHS: usize = 32;

/// A direction of the quadrature.
#[derive(Debug, Clone, Copy)]
pub(in crate::daylight) struct Direction {
    /// Cosine from the vertical.
    pub(in crate::daylight) rise: f64,
    pub(in crate::daylight) weight: f64,
}

/// Scattering between the directions, averaged over the azimuth.
pub(in crate::daylight) struct Exchange {
    pub(in crate::daylight) directions: [Direction; DIRECTIONS],
    /// 2π times the mean phase function from the second direction into the first, times the weight of the second.
    pub(in crate::daylight) kernel: [[f64; DIRECTIONS]; DIRECTIONS],
    pub(in crate::daylight) wide: WideScattering,
    pub(in crate::daylight) peak: ForwardPeak,
}

impl Exchange {
    pub(in crate::daylight) fn new(wide: WideScattering) -> Self {
        let nodes = SPLIT.into_iter().flat_map(|(low, high, count)| {
            // From the lowest to the highest.
            gauss_legendre(count)
                .into_iter()
                .rev()
                .map(move |(x, weight)| Direction {
                    rise: low + 0.5 * (high - low) * (x + 1.0),
                    weight: 0.5 * (high - low) * weight,
                })
        });
        let mut directions = [Direction {
            rise: 0.0,
            weight: 0.0,
        }; DIRECTIONS];
        for (to, node) in directions.iter_mut().zip(nodes) {
            *to = node;
        }
        let mut kernel = [[0.0; DIRECTIONS]; DIRECTIONS];
        for i in 0..DIRECTIONS {
            for j in 0..=i {
                let mean = azimuth_mean(directions[i].rise, directions[j].rise, |x| wide.density(x));
                (kernel[i][j], kernel[j][i]) = (TAU * mean, TAU * mean);
            }
        }
        for row in &mut kernel {
            for (value, direction) in row.iter_mut().zip(&directions) {
                *value *= direction.weight;
            }
            // The quadrature loses and gains no light.
            let sum: f64 = row.iter().sum();
            row.iter_mut().for_each(|value| *value *= wide.share / sum);
        }
        Self {
            directions,
            kernel,
            peak: ForwardPeak::new(&wide),
            wide,
        }
    }
}

/// Mean of a function of the angle between two cosines from the vertical over the azimuth.
pub(in crate::daylight) fn azimuth_mean(first: f64, second: f64, density_at: impl Fn(f64) -> f64) -> f64 {
    let across = ((1.0 - first * first) * (1.0 - second * second)).max(0.0).sqrt();
    let density = |k: usize| {
        let azimuth = PI * (k as f64 + 0.5) / AZIMUTHS as f64;
        density_at(first * second + across * azimuth.cos())
    };
    (0..AZIMUTHS).map(density).sum::<f64>() / AZIMUTHS as f64
}

/// `2π ∫ (1 − R(μ)) μ dμ`: what an even sky of radiance 1 in the water sends through the surface.
pub(super) fn sky_irradiance(directions: &[Direction]) -> f64 {
    let light = |direction: &Direction| (1.0 - fresnel(direction.rise)) * direction.rise * direction.weight;
    TAU * directions[FIRST_UP..].iter().map(light).sum::<f64>()
}
