//! The aureole of the sun: sunlight that only the forward peak of the phase function scattered.
//!
//! On a path s from the surface to the camera, particles scatter light into the peak n times with the probability `e^{−τ} τⁿ/n!`,
//! `τ = (1 − w) b s`. With the Legendre moments χ_l of the peak, the light of all n ≥ 1 has the distribution (Goudsmit and Saunderson
//! 1940)
//!
//! ```text
//! p_a(θ) = (1 − w)/(1 − e^{−τ}) Σ_l (2 l + 1)/(4π) e^{−l (l + 1) σ²/2} (e^{−τ (1 − χ_l)} − e^{−τ}) P_l(cos θ)
//! ```
//!
//! in 1/sr, with the integral 1 − w over the sphere. Waves spread the sun by σ. A ray collects `b E_s p_a ℓ(c + (1 − w) b − c μ/μ_s, Z)`:
//! the last scattering was at a point of it, and from there on all scattering attenuates.

use std::f64::consts::{PI, TAU};

use super::cumulative::CumulativePhase;
use super::wide::{PEAK_COSINE, WideScattering};
use crate::legendre::legendre_values;
use crate::polynomial::Polynomial;

/// Coefficients of the fit.
pub(super) const AUREOLE_TERMS: usize = 8;
/// No aureole is computed beyond 60° from the sun, of `1 − cos`: even after ten scatterings it is below 2 % of the light scattered widely.
pub(super) const REACH: f64 = 0.5;
/// Added to `1 − cos` in the argument of the fit, about the size of the core that waves leave.
pub(super) const CORE: f64 = 2e-3;
/// `(CORE + v)^{1/4}` in the middle of its range, and the inverse of half that range.
pub(super) const MIDDLE: f64 = 0.526_605_153;
pub(super) const STRETCH: f64 = 3.173_284_496;
/// Waves spread the sun by 1.5° along each axis, rad: slopes are 6° in a wind of 4 m/s (Cox and Munk 1954), and refraction turns light by a
/// quarter of them.
const WAVES: f64 = 0.027;
/// Legendre moments; the factor of the waves is below 1e-6 beyond.
const MOMENTS: usize = 200;
/// Rings of the peak, evenly spaced in the logarithm of their angle from [`NARROWEST`] on.
const RINGS: usize = 400;
/// Edge of the first ring, rad.
const NARROWEST: f64 = 1e-4;
/// Samples of the fit.
const SAMPLES: usize = 32;

/// Upper bound of the fit over its values at smaller angles: it is within 18 % of a function that falls.
const RIPPLE: f64 = 1.18 / 0.82;
/// Optical thickness below which only single scattering is left.
const THINNEST: f64 = 1e-6;

/// The forward peak of a phase function: what [`WideScattering`] leaves out.
#[derive(Debug, Clone)]
pub(super) struct ForwardPeak {
    /// χ_l.
    moments: [f64; MOMENTS],
    /// 1 − w.
    share: f64,
    /// The phase function at the edge of the peak, 1/sr.
    edge: f64,
}

impl ForwardPeak {
    pub(super) fn new(wide: &WideScattering) -> Self {
        let edge = wide.density(PEAK_COSINE);
        let mut moments = [0.0; MOMENTS];
        for ring in rings(wide.cumulative, edge) {
            let values: [f64; MOMENTS] = legendre_values(ring.cosine);
            for (moment, value) in moments.iter_mut().zip(values) {
                *moment += ring.light * value;
            }
        }
        let whole = moments[0].max(f64::MIN_POSITIVE);
        Self {
            moments: moments.map(|moment| moment / whole),
            share: (1.0 - wide.share).max(0.0),
            edge,
        }
    }

    /// The aureole after a path of this optical thickness of the peak.
    pub(super) fn aureole(&self, thickness: f64) -> Aureole {
        let series = self.series(thickness);
        let samples = (0..SAMPLES).map(|k| {
            let place = (PI * (k as f64 + 0.5) / SAMPLES as f64).cos();
            let versine = (MIDDLE + place / STRETCH).powi(4) - CORE;
            let light = series.density(1.0 - versine).max(0.0) + self.edge;
            [place, light.ln(), 1.0]
        });
        Aureole {
            logarithm: Polynomial::fit(samples),
            edge: self.edge,
        }
    }

    fn series(&self, thickness: f64) -> Series {
        let thickness = thickness.max(THINNEST);
        let unscattered = (-thickness).exp();
        let factor = self.share / (2.0 * TAU * (1.0 - unscattered));
        Series(std::array::from_fn(|l| {
            let degree = l as f64;
            let waves = (-0.5 * degree * (degree + 1.0) * WAVES * WAVES).exp();
            let light = (-thickness * (1.0 - self.moments[l])).exp() - unscattered;
            factor * (2.0 * degree + 1.0) * waves * light
        }))
    }
}

/// p_a as a sum over Legendre polynomials: the reference of [`Aureole`].
struct Series([f64; MOMENTS]);

impl Series {
    /// p_a at a cosine from the sun, 1/sr.
    fn density(&self, cosine: f64) -> f64 {
        let values: [f64; MOMENTS] = legendre_values(cosine);
        values.iter().zip(self.0).map(|(value, term)| value * term).sum()
    }
}

/// Scattering into a ring around the direction of light.
#[derive(Debug, Clone, Copy)]
struct Ring {
    cosine: f64,
    /// Its share of all scattered light, without the wide part.
    light: f64,
}

/// The peak in rings, from its center outward.
fn rings(phase: CumulativePhase, edge: f64) -> impl Iterator<Item = Ring> {
    let widest = PEAK_COSINE.acos();
    let angle = move |k: usize| NARROWEST * (widest / NARROWEST).powf(k as f64 / RINGS as f64);
    let versine = |angle: f64| 2.0 * (0.5 * angle).sin().powi(2);
    (0..=RINGS).map(move |k| {
        let inner = if k == 0 { 0.0 } else { angle(k - 1) };
        let [near, far] = [versine(inner), versine(angle(k))];
        let wide = edge * TAU * (far - near);
        Ring {
            cosine: (0.5 * (inner + angle(k))).cos(),
            light: (phase.within(far) - phase.within(near) - wide).max(0.0),
        }
    })
}

/// The aureole of one path: `ln(p_a + p(25°))` as a polynomial in `((CORE + v)^{1/4} − MIDDLE) STRETCH`, with v = 1 − cos of the angle
/// from the sun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Aureole {
    pub(super) logarithm: Polynomial<AUREOLE_TERMS>,
    /// p(25°).
    pub(super) edge: f64,
}

impl Aureole {
    /// p_a at `1 − cos` of the angle from the sun, 1/sr.
    pub(super) fn density(&self, versine: f64) -> f64 {
        if versine > REACH {
            return 0.0;
        }
        let place = ((versine + CORE).sqrt().sqrt() - MIDDLE) * STRETCH;
        (self.logarithm.value(place).exp() - self.edge).max(0.0)
    }

    /// An upper bound of p_a at this `1 − cos` and beyond, 1/sr: the aureole falls with the angle, and the fit follows it.
    pub(super) fn most(&self, versine: f64) -> f64 {
        if versine > REACH {
            return 0.0;
        }
        RIPPLE * (self.density(versine) + self.edge)
    }
}

#[cfg(test)]
mod tests {
    use spec::PhaseFunction;

    use super::*;
    use crate::legendre::gauss_legendre;

    /// The fit stays within this share of the aureole and p(25°) together; it cannot follow the corner of the peak at 25°.
    const FIT: f64 = 0.18;
    /// From 11° on, where p falls with the third power of the angle, waves of 1.5° raise it by `1.5²/2 · 9/11²` and less with each order.
    const SINGLE: f64 = 0.12;
    /// A quadrature over the fit has the integral of the peak to within this.
    const INTEGRAL: f64 = 0.05;
    const THICKNESSES: [f64; 6] = [0.0, 0.3, 1.0, 3.0, 8.0, 30.0];

    fn waters() -> impl Iterator<Item = WideScattering> {
        let phases = [PhaseFunction::Hg, PhaseFunction::Ff];
        let fractions = [0.002, 0.006, 0.0183, 0.04];
        phases
            .into_iter()
            .flat_map(move |phase| fractions.map(move |fraction| WideScattering::new(phase, fraction)))
    }

    #[test]
    fn the_fit_agrees_with_the_series() {
        for wide in waters() {
            let peak = ForwardPeak::new(&wide);
            for thickness in THICKNESSES {
                let (series, aureole) = (peak.series(thickness), peak.aureole(thickness));
                let mut nearer = f64::INFINITY;
                for tenths in 0..600 {
                    let versine = 1.0 - (0.1 * f64::from(tenths)).to_radians().cos();
                    let (exact, found) = (series.density(1.0 - versine), aureole.density(versine));
                    assert!(
                        (found - exact).abs() <= FIT * (exact + peak.edge),
                        "{wide:?} {thickness} at {tenths}: {found} for {exact}"
                    );
                    nearer = nearer.min(aureole.most(versine));
                    assert!(
                        found <= nearer,
                        "{wide:?} {thickness} at {tenths}: {found} above {nearer}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_thin_path_scatters_once_by_the_phase_function() {
        for wide in waters() {
            let peak = ForwardPeak::new(&wide);
            for degrees in [11.0f64, 14.0, 17.0, 21.0] {
                let versine = 1.0 - degrees.to_radians().cos();
                let (low, high) = (versine - 1e-5, versine + 1e-5);
                let light = wide.cumulative.within(high) - wide.cumulative.within(low);
                let exact = light / (TAU * (high - low));
                let found = peak.series(0.0).density(1.0 - versine) + peak.edge;
                assert!(
                    (found / exact - 1.0).abs() < SINGLE,
                    "{wide:?} at {degrees}: {found} for {exact}"
                );
            }
        }
    }

    #[test]
    fn the_aureole_has_all_light_that_the_peak_takes_from_the_beam() {
        for wide in waters() {
            let peak = ForwardPeak::new(&wide);
            for thickness in [0.0, 0.5, 2.0, 6.0] {
                let aureole = peak.aureole(thickness);
                // In the fourth root of the angle's versine, since most of the light is close to the sun.
                let sum: f64 = gauss_legendre(64)
                    .into_iter()
                    .map(|(x, weight)| {
                        let root = 0.5 * REACH.powf(0.25) * (1.0 + x);
                        let stretch = 4.0 * root.powi(3) * 0.5 * REACH.powf(0.25);
                        weight * TAU * stretch * aureole.density(root.powi(4))
                    })
                    .sum();
                let share = 1.0 - wide.share;
                assert!(
                    (sum / share - 1.0).abs() < INTEGRAL,
                    "{wide:?} {thickness}: {sum} for {share}"
                );
            }
        }
    }
}
