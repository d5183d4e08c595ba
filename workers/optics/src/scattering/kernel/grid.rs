//! The transfer function on the grid of a frame's cosine transform, in f32, as used by the fast forward scatter.

use std::f64::consts::TAU;

use imaging::vectorized;

use super::Transfer;
use super::fit::{TERMS, sinc};
use super::transfer::even_chebyshev;
use crate::attenuation::exp_negative;

/// H below this is omitted: one step of f32 relative to light of 1.
const NOTHING: f64 = 1e-7;
/// The same behind gates, relative to the response of the gate.
const NOTHING_BEHIND_GATES: f64 = 4e-7;
/// Folded terms add to H, at most three times the first.
const FOLDED: f64 = 4.0;

/// Highest frequencies of the kernels of light that passes a gate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GateReach {
    /// Largest amplification of a kernel by the gate as a natural logarithm, at least 0.
    pub(crate) amplification: f64,
    /// Scale of the kernel at the range of the gate, pixels.
    pub(crate) gamma_px: f64,
}

impl GateReach {
    /// Columns of the spectrum where a kernel of scale `gamma_px` over the response of the gate is above the threshold. In the unit of
    /// the kernel the response is at least 1, and at least the kernel of scale [`GateReach::gamma_px`].
    pub(crate) fn columns(&self, gamma_px: f64, width: usize) -> usize {
        /// Similar frames share their kernels.
        const STEP: usize = 16;
        let nothing = (FOLDED / NOTHING_BEHIND_GATES).ln();
        let alone = (nothing + self.amplification) / gamma_px;
        let beside = nothing / (gamma_px - self.gamma_px).max(0.0);
        let columns = (2 * width) as f64 * alone.min(beside) / TAU;
        (columns.ceil().min(width as f64) as usize)
            .next_multiple_of(STEP)
            .min(width)
    }
}

impl Transfer {
    /// Number of frequencies `p/2W` at which H of a kernel this wide can reach 1e-7.
    #[must_use]
    pub fn columns(&self, width: usize) -> usize {
        let reach = (FOLDED / NOTHING).ln() / (TAU * self.gamma());
        // A gamma of 0 reaches everywhere.
        ((2 * width) as f64 * reach).ceil().min(width as f64) as usize
    }

    /// H at `fx = p/2W`, `fy = q/2H`, column-major (`p · height + q`), within 5e-7 of [`Transfer::at_frequency`]; exactly 1 at (0, 0),
    /// so that all light arrives.
    #[must_use]
    pub fn grid_f32(&self, width: usize, height: usize) -> Vec<f32> {
        let mut grid = Vec::new();
        self.write_corner((width, height), width, height, &mut grid);
        grid
    }

    /// Replaces the content of `grid` by the first columns and rows of [`Transfer::grid_f32`].
    pub(crate) fn write_corner(
        &self,
        (width, height): (usize, usize),
        columns: usize,
        rows: usize,
        grid: &mut Vec<f32>,
    ) {
        let count = rows;
        let rows: Vec<f64> = (0..count).map(|q| q as f64 / (2 * height) as f64).collect();
        let row_sinc: Vec<f32> = rows.iter().map(|&fy| sinc(fy) as f32).collect();
        let row_squares: Vec<f32> = rows.iter().map(|&fy| (fy * fy) as f32).collect();
        let row_terms: [Vec<f32>; TERMS] =
            std::array::from_fn(|term| rows.iter().map(|&fy| even_chebyshev(fy)[term] as f32).collect());
        let scale = (TAU * self.gamma()) as f32;
        grid.resize(columns * count, 0.0);
        for (p, column) in grid.chunks_exact_mut(count.max(1)).enumerate() {
            let fx = p as f64 / (2 * width) as f64;
            let folded = self
                .folded_along(fx)
                .map(|folded| folded.map(|coefficient| coefficient as f32));
            let (square, across) = ((fx * fx) as f32, sinc(fx) as f32);
            vectorized!({
                main_term(column, &row_squares, &row_sinc, [scale, square, across]);
                if let Some(coefficients) = &folded {
                    add_terms(column, &row_terms, coefficients);
                }
            });
        }
        if let Some(mean) = grid.first_mut() {
            *mean = 1.0;
        }
    }
}

/// `sinc(fx) sinc(fy) exp(−scale |f|)` along fy.
#[inline(always)]
fn main_term(column: &mut [f32], squares: &[f32], sincs: &[f32], [scale, square, across]: [f32; 3]) {
    for (value, (&fy2, &sinc)) in column.iter_mut().zip(squares.iter().zip(sincs)) {
        *value = across * sinc * exp_negative(scale * (square + fy2).sqrt());
    }
}

/// Adds all terms in one pass.
#[inline(always)]
fn add_terms(sum: &mut [f32], terms: &[Vec<f32>; TERMS], coefficients: &[f32; TERMS]) {
    let count = sum.len();
    let [a, b, c, d, e, f, g, h, i] = terms.each_ref().map(|term| &term[..count]);
    for (q, sum) in sum.iter_mut().enumerate() {
        let values = [a[q], b[q], c[q], d[q], e[q], f[q], g[q], h[q], i[q]];
        for (value, coefficient) in values.iter().zip(coefficients) {
            *sum += coefficient * value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fast_grid_is_the_function_at_the_frequencies_of_the_cosine_transform() {
        let (width, height) = (37, 20);
        for gamma in [0.0, 0.04, 0.2, 0.8, 5.0, 7.0, 300.0] {
            let transfer = Transfer::new(gamma);
            let grid = transfer.grid_f32(width, height);
            let columns = transfer.columns(width);
            assert!(
                columns == width || gamma > 5.0 && columns > 0,
                "{columns} at γ = {gamma}"
            );
            assert!(
                grid[columns * height..].iter().all(|h| *h < NOTHING as f32),
                "γ = {gamma}"
            );
            let mut corner = vec![9.0; 5];
            transfer.write_corner((width, height), columns, height, &mut corner);
            assert_eq!(corner, grid[..columns * height]);
            transfer.write_corner((width, height), 1, 7, &mut corner);
            assert_eq!(corner, grid[..7]);
            assert_eq!(grid[0], 1.0);
            for (index, &value) in grid.iter().enumerate() {
                let (p, q) = (index / height, index % height);
                let expected =
                    transfer.at_frequency(p as f64 / (2 * width) as f64, q as f64 / (2 * height) as f64);
                assert!(
                    (f64::from(value) - expected).abs() < 5e-7,
                    "γ = {gamma} at ({p}, {q})"
                );
            }
        }
    }
}
