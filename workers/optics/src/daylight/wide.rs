//! Scattering outside of the forward peak.

use std::f64::consts::{PI, TAU};

use spec::PhaseFunction;

use super::cumulative::CumulativePhase;
use crate::legendre::{gauss_legendre, legendre_values};
use crate::polynomial::Polynomial;

/// Cosine of 25°. Light that is scattered by less stays with the ray that it comes from; surfaces and sky keep it.
pub(super) const PEAK_COSINE: f64 = 0.906_307_787;
/// Coefficients of the fit.
pub(super) const TERMS: usize = 8;
/// Samples of the fit.
const SAMPLES: usize = 24;
/// Legendre moments of [`WideScattering::repeated`].
const MOMENTS: usize = 16;
/// Nodes of their quadrature.
const NODES: usize = 64;
/// Step of the numerical derivative of the share within `1 − cos`.
const STEP: f64 = 1e-4;

/// The phase function with its peak cut off: within 25° it is that of 25°.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WideScattering {
    /// The phase function with its peak.
    pub(super) cumulative: CumulativePhase,
    /// Share of the scattered light that is left.
    pub share: f64,
    /// Logarithm of the phase function, 1/sr, by the cosine of the scattering angle.
    pub(super) logarithm: Polynomial<TERMS>,
}

impl WideScattering {
    /// That of water with this b_b/b.
    #[must_use]
    pub fn new(phase: PhaseFunction, backscatter_fraction: f64) -> Self {
        let cumulative = CumulativePhase::new(phase, backscatter_fraction);
        let density = |v: f64| {
            let (low, high) = ((v - STEP).max(0.0), (v + STEP).min(2.0));
            let light = cumulative.within(high) - cumulative.within(low);
            (light / (high - low) / TAU).max(f64::MIN_POSITIVE)
        };
        let peak = 1.0 - PEAK_COSINE;
        let samples = cosines().map(|cosine| [cosine, density(1.0 - cosine).ln(), 1.0]);
        Self {
            cumulative,
            share: 1.0 - cumulative.within(peak) + density(peak) * TAU * peak,
            logarithm: Polynomial::fit(samples),
        }
    }

    /// p at a cosine of the scattering angle, 1/sr; its integral over the sphere is [`WideScattering::share`].
    #[must_use]
    pub fn density(&self, cosine: f64) -> f64 {
        self.logarithm.value(cosine.clamp(-1.0, PEAK_COSINE)).exp()
    }

    /// The function of two scatterings in a row, `Σ (2 l + 1)/(4π) χ_l² P_l` with the Legendre moments χ_l of p.
    pub(super) fn repeated(&self) -> Repeated {
        let mut moments = [0.0; MOMENTS];
        for (cosine, weight) in gauss_legendre(NODES) {
            let light = TAU * weight * self.density(cosine);
            for (moment, value) in moments.iter_mut().zip(legendre_values::<MOMENTS>(cosine)) {
                *moment += light * value;
            }
        }
        Repeated {
            squares: moments.map(|moment| moment * moment),
        }
    }

    /// This function and `share` times that of two scatterings: a fit with the same number of terms.
    pub(super) fn with_repeated(&self, repeated: &Repeated, share: f64) -> Polynomial<TERMS> {
        Polynomial::fit(cosines().map(|cosine| {
            let sum = self.density(cosine) + share * repeated.density(cosine);
            [cosine, sum.max(f64::MIN_POSITIVE).ln(), 1.0]
        }))
    }
}

/// Light that was scattered twice by its angle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Repeated {
    squares: [f64; MOMENTS],
}

impl Repeated {
    pub(super) fn density(&self, cosine: f64) -> f64 {
        let terms = legendre_values::<MOMENTS>(cosine)
            .into_iter()
            .zip(self.squares)
            .enumerate();
        let sum: f64 = terms
            .map(|(l, (value, square))| (2.0 * l as f64 + 1.0) * square * value)
            .sum();
        (sum / (2.0 * TAU)).max(0.0)
    }
}

/// Chebyshev nodes of the cosines outside of the peak.
fn cosines() -> impl Iterator<Item = f64> {
    (0..SAMPLES).map(|k| {
        let x = (PI * (k as f64 + 0.5) / SAMPLES as f64).cos();
        PEAK_COSINE - 0.5 * (1.0 + PEAK_COSINE) * (1.0 - x)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lamp::asymmetry_of;

    /// The fit stays within this share of the phase function.
    const FIT: f64 = 0.05;

    #[test]
    fn the_fit_is_the_phase_function_outside_of_the_peak_and_integrates_to_its_share() {
        for fraction in [0.002, 0.0183, 0.1] {
            for phase in [PhaseFunction::Hg, PhaseFunction::Ff] {
                let wide = WideScattering::new(phase, fraction);
                let g = asymmetry_of(fraction);
                if phase == PhaseFunction::Hg {
                    for cosine in [-1.0f64, -0.4, 0.3, 0.9] {
                        let exact = (1.0 - g * g) / (2.0 * TAU * (1.0 + g * g - 2.0 * g * cosine).powf(1.5));
                        let fitted = wide.density(cosine);
                        assert!(
                            (fitted / exact - 1.0).abs() < FIT,
                            "{fraction} {cosine}: {fitted} {exact}"
                        );
                    }
                }
                let steps = 20_000;
                let cosine = |k: i32| -1.0 + (f64::from(k) + 0.5) * 2.0 / f64::from(steps);
                let sum: f64 = (0..steps).map(|k| wide.density(cosine(k))).sum();
                let integral = sum * TAU * 2.0 / f64::from(steps);
                assert!(
                    (integral / wide.share - 1.0).abs() < FIT,
                    "{phase:?} {fraction}: {integral} {wide:?}"
                );
            }
        }
    }
}
