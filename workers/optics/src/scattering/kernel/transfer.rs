//! The transfer function of the pixel-integrated kernel.
//!
//! `H(f) = Σ_{m,n} sinc(fx+m) sinc(fy+n) exp(−2πγ |f+(m,n)|)`, sinc(x) = sin(πx)/(πx): the spectrum of the continuous
//! kernel under the pixel's aperture, folded at the sampling rate. The term m = n = 0 is exact; the rest A is
//! smooth and even, and nine Chebyshev terms per axis carry it to 1e-8. For γ ≥ 6 A vanishes; below 0.3, where the direct
//! sum is long, A is interpolated in γ between γ = 0 (where H = 1) and twelve Chebyshev nodes.

use std::f64::consts::TAU;

use super::fit::{Coefficients, EXPONENT_LIMIT, FOLDS, GATED_LIMIT, INTERPOLATED_BELOW, TERMS, fit, sinc};
use super::narrow::TABLE;

/// From here on the folded terms are below exp(−22).
const NO_FOLDING: f64 = 6.0;
/// Narrower kernels have H above 1e-3, so exp(−22) is negligible.
const GATED_ABOVE: f64 = 2.0;
/// Wider ones have folded terms below exp(−31).
const GATED_NO_FOLDING: f64 = 10.0;

/// H of one γ.
#[derive(Debug, Clone, PartialEq)]
pub struct Transfer {
    gamma: f64,
    folded: Option<Coefficients>,
}

impl Transfer {
    /// Prepares H of `gamma` pixels (negative counts as 0).
    #[must_use]
    pub fn new(gamma: f64) -> Self {
        let gamma = gamma.max(0.0);
        let folded = (gamma < NO_FOLDING).then(|| {
            if gamma >= INTERPOLATED_BELOW {
                fit(|i, j| FOLDS.sum((i, j), gamma, EXPONENT_LIMIT))
            } else {
                TABLE.interpolate(gamma)
            }
        });
        Self { gamma, folded }
    }

    /// The same for light that passes gates. Folded terms are kept until they are negligible relative to the response of a gate, so that
    /// H divided by it is smooth in γ.
    #[must_use]
    pub(crate) fn behind_gates(gamma: f64) -> Self {
        if gamma <= GATED_ABOVE {
            return Self::new(gamma);
        }
        let is_folded = gamma < GATED_NO_FOLDING;
        Self {
            gamma,
            folded: is_folded.then(|| fit(|i, j| FOLDS.sum((i, j), gamma, GATED_LIMIT))),
        }
    }

    /// H at a frequency in cycles per pixel, |f| ≤ 1/2 per axis. H(0, 0) = 1.
    #[must_use]
    pub fn at_frequency(&self, fx: f64, fy: f64) -> f64 {
        let main = sinc(fx) * sinc(fy) * (-TAU * self.gamma * fx.hypot(fy)).exp();
        main + self
            .folded_along(fx)
            .map_or(0.0, |folded| dot(&folded, &even_chebyshev(fy)))
    }

    /// The scale it was made for, pixels.
    pub(super) fn gamma(&self) -> f64 {
        self.gamma
    }

    /// Coefficients of the folded part along fy, for one fx; `None` without folding.
    pub(super) fn folded_along(&self, fx: f64) -> Option<[f64; TERMS]> {
        let terms = even_chebyshev(fx);
        self.folded
            .as_ref()
            .map(|coefficients| coefficients.each_ref().map(|row| dot(row, &terms)))
    }

    /// H on the grid of the cosine transform, `fx = p/2W`, `fy = q/2H`, row-major in (q, p).
    #[must_use]
    pub fn grid(&self, width: usize, height: usize) -> Vec<f64> {
        let columns: Vec<f64> = (0..width).map(|p| p as f64 / (2 * width) as f64).collect();
        let column_sinc: Vec<f64> = columns.iter().map(|&fx| sinc(fx)).collect();
        let column_terms: Vec<[f64; TERMS]> = columns.iter().map(|&fx| even_chebyshev(fx)).collect();
        let mut grid = Vec::with_capacity(width * height);
        for q in 0..height {
            let fy = q as f64 / (2 * height) as f64;
            let row_sinc = sinc(fy);
            // H is symmetric in its two frequencies.
            let folded = self.folded_along(fy);
            for p in 0..width {
                let radius = (columns[p] * columns[p] + fy * fy).sqrt();
                let main = column_sinc[p] * row_sinc * (-TAU * self.gamma * radius).exp();
                grid.push(main + folded.map_or(0.0, |folded| dot(&folded, &column_terms[p])));
            }
        }
        grid
    }
}

fn dot(a: &[f64; TERMS], b: &[f64; TERMS]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `T_0, T_2, … T_16` at 2f.
pub(super) fn even_chebyshev(f: f64) -> [f64; TERMS] {
    // T_2p(x) = T_p(2x² − 1).
    let y = 8.0 * f * f - 1.0;
    let mut terms = [1.0; TERMS];
    terms[1] = y;
    for p in 2..TERMS {
        terms[p] = 2.0 * y * terms[p - 1] - terms[p - 2];
    }
    terms
}

#[cfg(test)]
mod tests {
    use super::super::fit::folded_sum;
    use super::*;

    /// The fit and the interpolation in γ each have an error below 1e-8.
    const FIT: f64 = 2e-8;

    #[test]
    fn all_light_arrives_whatever_the_spread() {
        for gamma in [0.0, 0.01, 0.1, 0.29, 0.31, 1.0, 5.9, 6.1, 50.0] {
            assert!(
                (Transfer::new(gamma).at_frequency(0.0, 0.0) - 1.0).abs() < FIT,
                "γ = {gamma}"
            );
        }
    }

    #[test]
    fn without_spread_every_frequency_passes() {
        let delta = Transfer::new(0.0);
        assert!((delta.at_frequency(0.3, 0.5) - 1.0).abs() < FIT);
        assert!((delta.at_frequency(0.5, 0.01) - 1.0).abs() < FIT);
    }

    #[test]
    fn the_fit_meets_the_direct_sum() {
        for gamma in [0.07, 0.2, 0.3, 0.7, 2.0] {
            let transfer = Transfer::new(gamma);
            for (fx, fy) in [(0.0, 0.5), (0.13, 0.31), (0.5, 0.5), (0.02, 0.44)] {
                let direct = sinc(fx) * sinc(fy) * (-TAU * gamma * f64::hypot(fx, fy)).exp()
                    + folded_sum(fx, fy, gamma, EXPONENT_LIMIT);
                assert!(
                    (transfer.at_frequency(fx, fy) - direct).abs() < FIT,
                    "γ = {gamma} at ({fx}, {fy})"
                );
            }
        }
    }

    /// A jump of H as small as exp(−22) would be one of a quarter after a division by exp(−20).
    #[test]
    fn behind_gates_the_transfer_is_smooth_where_folding_ends() {
        for gamma in [EXPONENT_LIMIT / TAU / 0.5, NO_FOLDING, 7.0, GATED_NO_FOLDING] {
            let [below, above] = [gamma - 1e-6, gamma + 1e-6].map(Transfer::behind_gates);
            for (fx, fy) in [(0.5, 0.0), (0.45, 0.1), (0.5, 0.2), (0.3, 0.3)] {
                let jump = below.at_frequency(fx, fy) - above.at_frequency(fx, fy);
                let gate = (-20f64).exp() + above.at_frequency(fx, fy);
                assert!(jump.abs() < 1e-4 * gate, "γ = {gamma} at ({fx}, {fy}): {jump:e}");
            }
        }
    }

    #[test]
    fn the_grid_is_the_function_at_the_frequencies_of_the_cosine_transform() {
        let transfer = Transfer::new(0.8);
        let grid = transfer.grid(5, 3);
        for q in 0..3 {
            for p in 0..5 {
                let value = transfer.at_frequency(p as f64 / 10.0, q as f64 / 6.0);
                assert!((grid[q * 5 + p] - value).abs() < 1e-14);
            }
        }
    }
}
