//! The point spread of forward scatter: a Cauchy kernel, integrated over pixels.
//!
//! Light that is scattered forward over a path of scale `γ` pixels arrives with the density `γ / (2π (γ² + r²)^{3/2})`, the
//! two-dimensional inverse Fourier transform of `exp(-2π γ |f|)`, f in cycles per pixel. A pixel receives the integral over its
//! square, so the kernel is positive, sums to 1 at every γ ≥ 0, and becomes a delta as γ → 0. Its tail falls only as γ/R: it must
//! not be cut off.

mod fit;
mod grid;
mod narrow;
mod transfer;

pub(crate) use grid::GateReach;
pub use transfer::Transfer;

use std::f64::consts::{PI, TAU};

/// Light of the kernel of scale `gamma` pixels that falls on the pixel at offset (i, j):
/// `Φ(i+½, j+½) − Φ(i−½, j+½) − Φ(i+½, j−½) + Φ(i−½, j−½)`, `Φ(x, y) = atan(xy / (γ √(γ²+x²+y²))) / 2π`.
///
/// Far out, where the four terms nearly cancel, the midpoint value with its second-order correction is used instead.
#[must_use]
pub fn pixel(i: i64, j: i64, gamma: f64) -> f64 {
    if gamma <= 0.0 {
        return if i == 0 && j == 0 { 1.0 } else { 0.0 };
    }
    let (x, y) = (i as f64, j as f64);
    let r2 = x * x + y * y;
    if r2 > FAR_R2 * gamma.max(1.0).powi(2) {
        let q = gamma * gamma + r2;
        return gamma / TAU * q.powf(-1.5) * (1.0 + (-6.0 / q + 15.0 * r2 / (q * q)) / 24.0);
    }
    let corner = |x: f64, y: f64| (x * y / (gamma * (gamma * gamma + x * x + y * y).sqrt())).atan() / TAU;
    corner(x + 0.5, y + 0.5) - corner(x - 0.5, y + 0.5) - corner(x + 0.5, y - 0.5) + corner(x - 0.5, y - 0.5)
}

/// Beyond 20 pixels (and 20 γ) the cancellation in the exact form is worse than the truncation of the series.
const FAR_R2: f64 = 400.0;

/// Light that stays on its pixel: `k(0,0) = (2/π) atan(1 / (4γ √(γ² + ½)))`.
#[must_use]
pub fn center(gamma: f64) -> f64 {
    if gamma <= 0.0 {
        1.0
    } else {
        2.0 / PI * (1.0 / (4.0 * gamma * (gamma * gamma + 0.5).sqrt())).atan()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kernel_is_positive_and_its_mass_within_a_radius_is_the_closed_form() {
        for gamma in [0.001, 0.1, 1.0, 3.0] {
            let reach = 60i64;
            let mut mass = 0.0;
            for j in -reach..=reach {
                for i in -reach..=reach {
                    let share = pixel(i, j, gamma);
                    assert!(share > 0.0);
                    mass += share;
                }
            }
            // The square of side 2R+1 has the mass of its four corners' integral.
            let half = reach as f64 + 0.5;
            let square =
                4.0 * (half * half / (gamma * (gamma * gamma + 2.0 * half * half).sqrt())).atan() / TAU;
            assert!(
                (mass - square).abs() < 1e-8,
                "γ = {gamma}: {mass} against {square}"
            );
        }
    }

    #[test]
    fn the_series_meets_the_exact_form_where_it_takes_over() {
        for gamma in [0.2, 1.0, 5.0] {
            let i = (20.0 * f64::max(gamma, 1.0)) as i64;
            let (inside, outside) = (pixel(i, 0, gamma), pixel(i + 1, 0, gamma));
            let ratio =
                ((gamma * gamma + ((i + 1) * (i + 1)) as f64) / (gamma * gamma + (i * i) as f64)).powf(1.5);
            assert!((inside / outside / ratio - 1.0).abs() < 1e-4, "γ = {gamma}");
        }
    }

    #[test]
    fn a_kernel_without_width_is_a_delta() {
        assert_eq!((pixel(0, 0, 0.0), pixel(1, 0, 0.0), center(0.0)), (1.0, 0.0, 1.0));
        assert!((center(0.01) - (1.0 - 1.80 * 0.01)).abs() < 1e-4);
        assert!((center(2.5) - pixel(0, 0, 2.5)).abs() < 1e-15);
    }
}
