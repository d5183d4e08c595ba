//! Chebyshev fits of the folded part of a transfer function, and its terms at their nodes.

use std::array::from_fn;
use std::f64::consts::{PI, TAU};
use std::sync::LazyLock;

/// Even Chebyshev terms per axis.
pub(super) const TERMS: usize = 9;
/// exp(−22) = 3e-10: the omitted part of the direct sum.
pub(super) const EXPONENT_LIMIT: f64 = 22.0;
/// Behind gates H is divided by a response of at least exp(−20), so that folded terms matter down to exp(−34).
pub(super) const GATED_LIMIT: f64 = 34.0;
/// Narrower kernels have long sums, so A is interpolated in γ.
pub(super) const INTERPOLATED_BELOW: f64 = 0.3;

pub(super) type Coefficients = [[f64; TERMS]; TERMS];

/// The farthest term of the sums of kernels that are not interpolated: 12 for γ = 0.3.
const FARTHEST_FOLD: i64 = 13;
const FOLD_COUNT: usize = 2 * FARTHEST_FOLD as usize + 1;

pub(super) static FOLDS: LazyLock<Folds> = LazyLock::new(Folds::new);

/// The factors of folded sums at the nodes of [`fit`] that do not depend on γ.
pub(super) struct Folds {
    /// sinc(f + m) by node and m.
    sincs: [[f64; FOLD_COUNT]; TERMS],
    /// |f + (m, n)| by both nodes, n and m.
    distances: Vec<[[f64; FOLD_COUNT]; FOLD_COUNT]>,
}

impl Folds {
    fn new() -> Self {
        let shifted = |i: usize, m: usize| node(i) + (m as i64 - FARTHEST_FOLD) as f64;
        let distances = |i: usize, j: usize| from_fn(|n| from_fn(|m| shifted(i, m).hypot(shifted(j, n))));
        Self {
            sincs: from_fn(|i| from_fn(|m| sinc(shifted(i, m)))),
            distances: (0..TERMS * TERMS)
                .map(|pair| distances(pair / TERMS, pair % TERMS))
                .collect(),
        }
    }

    /// The terms other than m = n = 0 at two nodes, summed up to `limit`; γ is at least [`INTERPOLATED_BELOW`].
    pub(super) fn sum(&self, (i, j): (usize, usize), gamma: f64, limit: f64) -> f64 {
        let (fx, fy) = (node(i), node(j));
        let distances = &self.distances[i * TERMS + j];
        let radius = limit / (TAU * gamma);
        let mut sum = 0.0;
        for n in -FARTHEST_FOLD..=FARTHEST_FOLD {
            let y = fy + n as f64;
            if y.abs() > radius {
                continue;
            }
            let row = (n + FARTHEST_FOLD) as usize;
            let across = self.sincs[j][row];
            let half = (radius * radius - y * y).sqrt();
            for m in (-half - fx).ceil() as i64..=(half - fx).floor() as i64 {
                if m != 0 || n != 0 {
                    let column = (m + FARTHEST_FOLD) as usize;
                    sum += across * self.sincs[i][column] * (-TAU * gamma * distances[row][column]).exp();
                }
            }
        }
        sum
    }
}

pub(super) fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-9 {
        1.0
    } else {
        (PI * x).sin() / (PI * x)
    }
}

/// Angle of a Chebyshev node.
fn angle(n: usize) -> f64 {
    (n as f64 + 0.5) * PI / (2 * TERMS) as f64
}

/// Frequency of a Chebyshev node.
pub(super) fn node(n: usize) -> f64 {
    0.5 * angle(n).cos()
}

/// Chebyshev coefficients of an even function of both axes from its values at the nine positive nodes per axis.
pub(super) fn fit(value: impl Fn(usize, usize) -> f64) -> Coefficients {
    let mut values = [[0.0; TERMS]; TERMS];
    for i in 0..TERMS {
        for j in 0..=i {
            // Even in both axes and symmetric in them.
            values[i][j] = value(i, j);
            values[j][i] = values[i][j];
        }
    }
    let weights: Coefficients = from_fn(|p| {
        let scale = (if p == 0 { 1.0 } else { 2.0 }) / TERMS as f64;
        from_fn(|n| scale * ((2 * p) as f64 * angle(n)).cos())
    });
    let mut coefficients = [[0.0; TERMS]; TERMS];
    for (p, row) in coefficients.iter_mut().enumerate() {
        for (q, coefficient) in row.iter_mut().enumerate() {
            for (i, line) in values.iter().enumerate() {
                for (j, value) in line.iter().enumerate() {
                    *coefficient += weights[p][i] * weights[q][j] * value;
                }
            }
        }
    }
    coefficients
}

/// Reference of [`Folds::sum`], at any frequency and for any γ.
#[cfg(test)]
pub(super) fn folded_sum(fx: f64, fy: f64, gamma: f64, limit: f64) -> f64 {
    let radius = limit / (TAU * gamma);
    let reach = radius.ceil() as i64 + 1;
    let mut sum = 0.0;
    for n in -reach..=reach {
        let y = fy + n as f64;
        if y.abs() > radius {
            continue;
        }
        let across = sinc(y);
        let half = (radius * radius - y * y).sqrt();
        for m in (-half - fx).ceil() as i64..=(half - fx).floor() as i64 {
            if m != 0 || n != 0 {
                let x = fx + m as f64;
                sum += across * sinc(x) * (-TAU * gamma * x.hypot(y)).exp();
            }
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_at_nodes_are_the_direct_sums() {
        for gamma in [INTERPOLATED_BELOW, 0.7, 2.0, 5.9, 9.9] {
            for limit in [EXPONENT_LIMIT, GATED_LIMIT]
                .into_iter()
                .filter(|&limit| limit < 75.0 * gamma)
            {
                for (i, j) in [(0, 0), (3, 1), (TERMS - 1, 0), (TERMS - 1, TERMS - 1)] {
                    let sum = FOLDS.sum((i, j), gamma, limit);
                    assert_eq!(sum, folded_sum(node(i), node(j), gamma, limit), "γ = {gamma}");
                }
            }
        }
    }
}
