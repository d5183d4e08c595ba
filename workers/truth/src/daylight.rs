//! The sky and the sun of a frame with daylight on its surfaces.

use std::f64::consts::TAU;

use imaging::vector::DVec3;
use optics::daylight::{CRITICAL_COSINE, Daylight};

use crate::sea::{Sea, SeaSun, fresnel};

/// Steps of the integral of a uniform sky over the surface: relative error 1e-6.
const STEPS: usize = 4096;

impl Sea {
    /// The sea of a frame: a flat surface, a uniform sky and a sun whose combined irradiance just below the surface is
    /// that of this daylight, in units where white has a radiance of 1. `None` if the irradiance overflows.
    #[must_use]
    pub fn of_daylight(daylight: &Daylight) -> Option<Self> {
        let irradiance = daylight.at_surface();
        if irradiance.iter().any(|light| !light.is_finite()) {
            return None;
        }
        let gaze = daylight.gaze();
        let sun = daylight.sun();
        let share = sun.map_or(0.0, |sun| sun.share.clamp(0.0, 1.0));
        Some(Self {
            up: DVec3::from(gaze.up).normalized(),
            depth_m: daylight.depth(),
            sky: irradiance.map(|light| (1.0 - share) * light / sky_irradiance()),
            sun: sun.map(|sun| SeaSun {
                direction: DVec3::from(sun.toward(gaze)).normalized(),
                irradiance: irradiance.map(|light| share * light / sun.rise),
            }),
        })
    }
}

/// Irradiance just below the surface under a uniform sky whose radiance in the water is 1 before surface reflection:
/// `2π ∫ (1 − R(μ)) μ dμ` over the cone of the visible sky.
fn sky_irradiance() -> f64 {
    // In μ = μ_c + (1 − μ_c) u², since R starts as a square root at the edge of the cone.
    let width = 1.0 - CRITICAL_COSINE;
    let steps = (0..STEPS).map(|k| {
        let u = (k as f64 + 0.5) / STEPS as f64;
        let cosine = CRITICAL_COSINE + width * u * u;
        (1.0 - fresnel(cosine)) * cosine * 2.0 * width * u
    });
    TAU * steps.sum::<f64>() / STEPS as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sea::REFRACTIVE_INDEX;

    #[test]
    fn an_even_sky_loses_at_the_surface_what_walsh_gives() {
        // Walsh 1926: the reflectance of a flat surface of index n for diffuse light.
        let n = REFRACTIVE_INDEX;
        let (square, fourth) = (n * n, n.powi(4));
        let reflected = 0.5
            + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
            + square * (square - 1.0).powi(2) / (square + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
            - 2.0 * n.powi(3) * (square + 2.0 * n - 1.0) / ((square + 1.0) * (fourth - 1.0))
            + 8.0 * fourth * (fourth + 1.0) / ((square + 1.0) * (fourth - 1.0).powi(2)) * n.ln();
        let above = std::f64::consts::PI / square;
        assert!((sky_irradiance() / above - (1.0 - reflected)).abs() < 1e-6);
    }
}
