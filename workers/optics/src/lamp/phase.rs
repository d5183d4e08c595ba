//! The phase function: where a particle sends the light that it scatters.

use std::f64::consts::PI;

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
    // Sixty halvings leave less than the spacing of doubles.
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
}
