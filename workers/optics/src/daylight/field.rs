//! The radiance of the water in every direction: two numbers from a, b and b_b/b, and Snell's window.

use std::f64::consts::PI;

/// Refractive index of sea water.
pub const REFRACTIVE_INDEX: f64 = 1.34;
/// Cosine from the vertical beyond which no sky is seen, `sqrt(1 − 1/n²)`.
pub const CRITICAL_COSINE: f64 = 0.665_644_869_282_918_2;
/// How far inside the window's edge its reflectance is taken at least: at the edge itself it is 1.
pub(super) const EDGE_INSIDE: f64 = 0.02;
/// Least cosine in the exponent of the window.
pub(super) const LEAST_COSINE: f64 = 1e-3;
/// The window is at most e to this power times as bright as the irradiance at the camera. Only in depths far beyond those that the
/// field holds for would it be brighter.
pub(super) const MOST_GAIN: f64 = 20.0;
/// The darkest horizon, where the water scatters nothing.
const LEAST_HORIZON: f64 = 1e-5;
const MOST_HORIZON: f64 = 0.15;
const BRIGHT_CEILING: f64 = 2.5;

/// How radiance depends on the direction, with its level against the irradiance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// Λ, radiance of the horizon over downwelling irradiance, per steradian.
    pub horizon: f64,
    /// p, slope of the logarithm of radiance with the cosine from the vertical.
    pub p: f64,
    /// q, its curvature.
    pub q: f64,
}

/// The radiance field of one channel. Coefficients are per unit of range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Field {
    /// Its shape.
    pub shape: Shape,
    /// K, the decay of irradiance with depth.
    pub decay: f64,
    /// a + 0.1 b, by which the sky fades on its way down.
    pub window: f64,
    /// b, which blurs the edge of the window.
    pub scattering: f64,
}

/// `K = sqrt(a² + 0.19 a b)/0.83`, the decay of daylight in water of this absorption and scattering: within 8 % for b_b/b of
/// 0.008 to 0.0183 under an overcast sky.
#[must_use]
pub fn decay_from(absorption: f64, scattering: f64) -> f64 {
    (absorption * absorption + 0.19 * absorption * scattering).sqrt() / 0.83
}

/// Reflectance of the sea surface from within the water for light that is not polarized, at a cosine from the vertical: 1 beyond
/// the critical angle (Fresnel).
#[must_use]
pub fn fresnel(cosine: f64) -> f64 {
    let n = REFRACTIVE_INDEX;
    let sine_in_air = n * n * (1.0 - cosine * cosine);
    if sine_in_air >= 1.0 {
        return 1.0;
    }
    let k = (1.0 - sine_in_air).sqrt();
    let across = (n * cosine - k) / (n * cosine + k);
    let along = (cosine - n * k) / (cosine + n * k);
    0.5 * (across * across + along * along)
}

impl Shape {
    /// The shape that follows from absorption and backscattering b_b, 1/m.
    #[must_use]
    pub fn of_water(absorption: f64, backscattering: f64) -> Self {
        let horizon = 0.47 * backscattering / absorption.max(f64::MIN_POSITIVE);
        let horizon = horizon.min(MOST_HORIZON).max(LEAST_HORIZON);
        let q = ((0.45 * (1.0 / horizon).ln() - 0.76) / 1.03).clamp(0.0, BRIGHT_CEILING);
        Self {
            horizon,
            p: 1.6 + q,
            q,
        }
    }

    /// `Φ(μ) = exp(p μ + q μ²)`.
    #[must_use]
    pub fn phi(&self, rise: f64) -> f64 {
        (rise * (self.p + self.q * rise)).exp()
    }

    /// Least and greatest Φ between two cosines.
    pub(crate) fn extremes(&self, (low, high): (f64, f64)) -> (f64, f64) {
        let turn = if self.q == 0.0 {
            low
        } else {
            -self.p / (2.0 * self.q)
        };
        let values = [low, high, turn.clamp(low, high)].map(|rise| self.phi(rise));
        let least = values.into_iter().fold(f64::INFINITY, f64::min);
        (least, values.into_iter().fold(0.0, f64::max))
    }
}

impl Field {
    /// Width of the window's edge in the cosine, at a depth: `0.02 + 0.02 min(b z, 10)`.
    #[must_use]
    pub fn edge(&self, depth: f64) -> f64 {
        0.02 + 0.02 * (self.scattering * depth).min(10.0)
    }

    /// `W(μ, z) / E(z)`: the sky through the surface over the irradiance at the depth,
    /// `(1 − R(μ)) (n²/π) e^{−(a + 0.1 b) z/μ + K z}` within the window, whose edge is smooth.
    #[must_use]
    pub fn sky(&self, rise: f64, depth: f64) -> f64 {
        let s = ((rise - CRITICAL_COSINE) / self.edge(depth) + 0.5).clamp(0.0, 1.0);
        if s == 0.0 {
            return 0.0;
        }
        let through = 1.0 - fresnel(rise.max(CRITICAL_COSINE + EDGE_INSIDE));
        let lost = self.window * depth / rise.max(LEAST_COSINE) - self.decay * depth;
        let arriving = (-lost).min(MOST_GAIN).exp();
        through * REFRACTIVE_INDEX * REFRACTIVE_INDEX / PI * arriving * s * s * (3.0 - 2.0 * s)
    }

    /// `L(v, z) / E(z)`: radiance in a direction over the irradiance at the depth.
    #[must_use]
    pub fn radiance(&self, rise: f64, depth: f64) -> f64 {
        (self.shape.horizon * self.shape.phi(rise)).max(self.sky(rise, depth))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_critical_cosine_is_that_of_the_index() {
        let exact = (1.0 - 1.0 / REFRACTIVE_INDEX.powi(2)).sqrt();
        assert!((CRITICAL_COSINE - exact).abs() < 1e-15, "{exact:.17}");
        assert_eq!(fresnel(CRITICAL_COSINE - 1e-9), 1.0);
        assert!((fresnel(1.0) - (0.34f64 / 2.34).powi(2)).abs() < 1e-12);
    }

    #[test]
    fn the_horizon_is_brighter_than_what_is_below_and_darker_than_the_window() {
        let shape = Shape::of_water(0.179, 0.219 * 0.0183);
        assert!((shape.phi(-1.0) - (-1.6f64).exp()).abs() < 1e-12);
        assert_eq!(shape.phi(0.0), 1.0);
        let field = Field {
            shape,
            decay: decay_from(0.179, 0.219),
            window: 0.179 + 0.1 * 0.219,
            scattering: 0.219,
        };
        assert!(field.radiance(1.0, 7.0) > 20.0 * field.radiance(0.0, 7.0));
        // The edge of the window is no step.
        let steps = (0..400).map(|i| 0.5 + 1e-3 * f64::from(i));
        let radiances: Vec<f64> = steps.map(|rise| field.radiance(rise, 7.0)).collect();
        let most = radiances
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .fold(0.0, f64::max);
        assert!(most < 0.06 * radiances[399], "{most}");
    }

    #[test]
    fn water_that_scatters_or_absorbs_nothing_has_a_field() {
        for (a, b) in [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0)] {
            let shape = Shape::of_water(a, b);
            assert!(shape.phi(1.0).is_finite() && shape.horizon >= LEAST_HORIZON);
        }
    }

    #[test]
    fn no_direction_between_two_is_outside_the_extremes() {
        for (p, q) in [(0.0, 0.0), (2.0, -3.0), (1.0, 2.0), (10.0, -5.0)] {
            let shape = Shape { horizon: 0.01, p, q };
            for (low, high) in [(-1.0, 1.0), (-0.3, 0.4), (0.2, 0.2)] {
                let (least, most) = shape.extremes((low, high));
                for step in 0..=100 {
                    let phi = shape.phi(low + (high - low) * f64::from(step) / 100.0);
                    assert!(phi >= least * 0.999_999 && phi <= most * 1.000_001);
                }
            }
        }
    }
}
