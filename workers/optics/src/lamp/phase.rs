//! The phase function: where a particle sends the light that it scatters.

use std::f64::consts::PI;

use super::particles::FournierForand;

/// Share that an average sea particle scatters backwards (Petzold 1972; Mobley 1994).
pub const AVERAGE_BACKSCATTER_FRACTION: f64 = 0.0183;

/// Henyey–Greenstein phase function in 1/sr: `p = (1 − g²) / (4π (1 + g² − 2 g cos)^{3/2})`, −1 < g < 1 (Henyey & Greenstein
/// 1941). Its integral over the sphere is 1. It lacks the rise toward 180° that sea water shows.
#[must_use]
pub fn henyey_greenstein(g: f64, cos: f64) -> f64 {
    let square = 1.0 + g * g - 2.0 * g * cos;
    (1.0 - g * g) / (4.0 * PI * square * square.sqrt())
}

/// b_b/b of the phase function: its integral over the backward half, `(1 − g)/(2 g) ((1 + g)/√(1 + g²) − 1)`; 1/2 at g = 0.
#[must_use]
pub fn backscatter_fraction(g: f64) -> f64 {
    if g.abs() < 1e-6 {
        // The fraction of differences loses its digits; the slope at 0 is −3/4.
        return 0.5 - 0.75 * g;
    }
    (1.0 - g) / (2.0 * g) * ((1.0 + g) / (1.0 + g * g).sqrt() - 1.0)
}

/// The g of a backscatter fraction b_b/b within 0..=1: the inverse of [`backscatter_fraction`], which falls with g.
#[must_use]
pub fn asymmetry_of(fraction: f64) -> f64 {
    let (mut low, mut high) = (-0.999_999, 0.999_999);
    // The error after sixty halvings is below the spacing of doubles.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if backscatter_fraction(middle) > fraction {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// The phase function of the airlight of lamps: `p = p_HG(g) + K (3 cos² − 1)` in 1/sr, whose integral over the sphere is 1.
///
/// With K = 0 it is that of Henyey and Greenstein, which falls up to 180°. Sea water rises from 120° on; the term of K is the one that
/// Fournier and Forand have for that ([`FournierForand::rise`]). It moves light within the backward half, so that b_b/b stays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GlowPhase {
    /// g, −1 < g < 1.
    pub asymmetry: f64,
    /// K, 0 or more, 1/sr.
    pub rise: f64,
}

impl GlowPhase {
    /// Henyey and Greenstein with this asymmetry.
    #[must_use]
    pub fn henyey_greenstein(asymmetry: f64) -> Self {
        Self { asymmetry, rise: 0.0 }
    }

    /// Approximates Fournier and Forand with a backscatter fraction b_b/b within 0.002..=0.5: g and K are those of the fraction.
    /// From 90° to 180° it is within 12 % of theirs for fractions of 0.005 to 0.03, compared with 0.60 to 1.23 times theirs for
    /// Henyey and Greenstein. At smaller angles it is close to Henyey and Greenstein.
    #[must_use]
    pub fn fournier_forand(fraction: f64) -> Self {
        Self {
            asymmetry: asymmetry_of(fraction),
            rise: FournierForand::of_backscatter(fraction).rise(),
        }
    }

    /// p at a cosine of the scattering angle, 1/sr.
    #[must_use]
    pub fn density(&self, cos: f64) -> f64 {
        henyey_greenstein(self.asymmetry, cos) + self.rise * (3.0 * cos * cos - 1.0)
    }

    /// Monotonic upper bound of p. The change of p between two angles is at most the sum of this at both.
    pub(super) fn most(&self, cos: f64) -> f64 {
        henyey_greenstein(self.asymmetry, cos) + 3.0 * self.rise
    }
}

#[cfg(test)]
mod tests {
    use super::super::gauss_legendre;
    use super::*;

    #[test]
    fn the_phase_function_sums_to_one_and_its_back_to_the_fraction() {
        for g in [-0.5, 0.0, 0.3, 0.7, 0.9] {
            let rule = gauss_legendre(128);
            let whole: f64 = rule
                .iter()
                .map(|(x, w)| 2.0 * PI * w * henyey_greenstein(g, *x))
                .sum();
            let back: f64 = rule
                .iter()
                .map(|(x, w)| PI * w * henyey_greenstein(g, 0.5 * (x - 1.0)))
                .sum();
            assert!((whole - 1.0).abs() < 1e-9, "{g}: {whole}");
            assert!((back - backscatter_fraction(g)).abs() < 1e-9, "{g}: {back}");
            assert!((asymmetry_of(backscatter_fraction(g)) - g).abs() < 1e-9, "{g}");
        }
    }

    #[test]
    fn known_fractions_have_their_known_asymmetry() {
        for (fraction, g) in [(0.0183, 0.919), (0.013, 0.941), (0.044, 0.822)] {
            assert!((asymmetry_of(fraction) - g).abs() < 1e-3, "{fraction}");
        }
    }

    #[test]
    fn with_a_rise_the_phase_function_is_positive_sums_to_one_and_keeps_the_fraction() {
        let rule = gauss_legendre(128);
        for fraction in (1..=250).map(|step| 0.002 * f64::from(step)) {
            let phase = GlowPhase::fournier_forand(fraction);
            let cosines = (0..=2000).map(|step| f64::from(step) / 1000.0 - 1.0);
            let least = cosines
                .map(|cos| phase.density(cos))
                .fold(f64::INFINITY, f64::min);
            assert!(least > 0.0, "{fraction}: {least}");
            let back: f64 = rule
                .iter()
                .map(|(x, w)| PI * w * phase.density(0.5 * (x - 1.0)))
                .sum();
            assert!((back - fraction).abs() < 1e-9, "{fraction}: {back}");
        }
        let whole: f64 = rule
            .iter()
            .map(|(x, w)| 2.0 * PI * w * GlowPhase::fournier_forand(0.0183).density(*x))
            .sum();
        assert!((whole - 1.0).abs() < 1e-6, "{whole}");
    }

    #[test]
    fn with_a_rise_it_goes_backward_nearly_as_that_of_fournier_and_forand() {
        let ratios = |fraction: f64, phase: GlowPhase| {
            let law = FournierForand::of_backscatter(fraction);
            let density = move |cos: f64| {
                let (near, far) = (1.0 - cos - 1e-4, (1.0 - cos + 1e-4).min(2.0));
                (law.within(far) - law.within(near)) / (2.0 * PI * (far - near))
            };
            let ratios = (0..=90).map(|step| f64::from(180 - step).to_radians().cos());
            ratios
                .map(|cos| phase.density(cos) / density(cos))
                .fold((f64::INFINITY, 0.0f64), |(least, most), v| {
                    (least.min(v), most.max(v))
                })
        };
        for fraction in [0.005, 0.01, 0.0183, 0.03] {
            let (least, most) = ratios(fraction, GlowPhase::fournier_forand(fraction));
            assert!(least > 0.92 && most < 1.12, "{fraction}: {least} {most}");
        }
        let (least, most) = ratios(0.03, GlowPhase::henyey_greenstein(asymmetry_of(0.03)));
        assert!(least < 0.61 && most > 1.22, "{least} {most}");
    }
}
