//! The folded part of narrow kernels, whose sums are long: interpolated in γ.

use std::f64::consts::PI;
use std::sync::LazyLock;

use super::fit::{Coefficients, INTERPOLATED_BELOW, TERMS};

const INTERPOLATED_FROM: f64 = 0.05;
const GAMMA_NODES: usize = 12;

/// Little-endian coefficients at each node, made by the test `the_table_holds_the_sums`: they take 45 ms, more than the plan of a frame.
const FOLDED: &[u8; (1 + GAMMA_NODES) * TERMS * TERMS * 8] = include_bytes!("folded.f64");

pub(super) static TABLE: LazyLock<SmallGamma> = LazyLock::new(SmallGamma::read);

/// Coefficients at γ = 0 and at Chebyshev nodes of [0.05, 0.3], and barycentric interpolation between them.
pub(super) struct SmallGamma {
    nodes: Vec<f64>,
    weights: Vec<f64>,
    coefficients: Vec<Coefficients>,
}

impl SmallGamma {
    fn read() -> Self {
        let middle = (INTERPOLATED_BELOW + INTERPOLATED_FROM) / 2.0;
        let half = (INTERPOLATED_BELOW - INTERPOLATED_FROM) / 2.0;
        let node = |k: usize| middle + half * (PI * (k as f64 + 0.5) / GAMMA_NODES as f64).cos();
        let nodes: Vec<f64> = std::iter::once(0.0).chain((0..GAMMA_NODES).map(node)).collect();
        let weight = |k: usize| {
            let others = nodes.iter().enumerate().filter(|(other, _)| *other != k);
            1.0 / others
                .map(|(_, &other)| (nodes[k] - other) / half)
                .product::<f64>()
        };
        let weights = (0..nodes.len()).map(weight).collect();
        let coefficients = FOLDED.chunks_exact(TERMS * TERMS * 8).map(read_coefficients);
        let coefficients = coefficients.collect();
        Self {
            nodes,
            weights,
            coefficients,
        }
    }

    pub(super) fn interpolate(&self, gamma: f64) -> Coefficients {
        if let Some(exact) = self.nodes.iter().position(|&node| node == gamma) {
            return self.coefficients[exact];
        }
        let shares: Vec<f64> = self
            .nodes
            .iter()
            .zip(&self.weights)
            .map(|(n, w)| w / (gamma - n))
            .collect();
        let total: f64 = shares.iter().sum();
        let mut mixed = [[0.0; TERMS]; TERMS];
        for (coefficients, share) in self.coefficients.iter().zip(&shares) {
            for (row, line) in mixed.iter_mut().zip(coefficients) {
                for (sum, coefficient) in row.iter_mut().zip(line) {
                    *sum += share / total * coefficient;
                }
            }
        }
        mixed
    }
}

fn read_coefficients(bytes: &[u8]) -> Coefficients {
    let (numbers, _) = bytes.as_chunks();
    let mut numbers = numbers.iter().map(|number| f64::from_le_bytes(*number));
    let mut next = || numbers.next().unwrap_or_default();
    std::array::from_fn(|_| std::array::from_fn(|_| next()))
}

#[cfg(test)]
mod tests {
    use super::super::fit::{EXPONENT_LIMIT, fit, folded_sum, node, sinc};
    use super::*;

    /// A at γ, from the direct sum.
    fn fit_folded(gamma: f64) -> Coefficients {
        if gamma == 0.0 {
            fit(|i, j| 1.0 - sinc(node(i)) * sinc(node(j)))
        } else {
            fit(|i, j| folded_sum(node(i), node(j), gamma, EXPONENT_LIMIT))
        }
    }

    /// With `FATHOM_WRITE=1` it writes the table. Sums differ by their last digits between libraries for exp.
    #[test]
    fn the_table_holds_the_sums() {
        let table = SmallGamma::read();
        let sums: Vec<Coefficients> = table.nodes.iter().map(|&gamma| fit_folded(gamma)).collect();
        if std::env::var_os("FATHOM_WRITE").is_some() {
            let bytes: Vec<u8> = sums
                .as_flattened()
                .as_flattened()
                .iter()
                .flat_map(|v| v.to_le_bytes())
                .collect();
            let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/scattering/kernel/folded.f64");
            std::fs::write(path, bytes).unwrap();
            return;
        }
        let pairs = sums
            .as_flattened()
            .as_flattened()
            .iter()
            .zip(table.coefficients.as_flattened().as_flattened());
        for (sum, held) in pairs {
            assert!((sum - held).abs() < 1e-14, "{sum} {held}");
        }
    }
}
