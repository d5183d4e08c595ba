//! Polynomials fitted to a few samples, cheap enough to evaluate at every pixel.

/// `Σ c_i x^i`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Polynomial<const N: usize>(pub(crate) [f64; N]);

impl<const N: usize> Polynomial<N> {
    /// The least-squares fit to samples (x, y, weight) with x in −1..=1; there must be at least N different x.
    #[must_use]
    pub(crate) fn fit(samples: impl IntoIterator<Item = [f64; 3]>) -> Self {
        let mut normal = [[0.0; N]; N];
        let mut right = [0.0; N];
        for [x, y, weight] in samples {
            let basis = chebyshev::<N>(x);
            for i in 0..N {
                right[i] += weight * basis[i] * y;
                for j in 0..N {
                    normal[i][j] += weight * basis[i] * basis[j];
                }
            }
        }
        Self(to_monomials(solve(normal, right)))
    }

    /// Its value.
    #[must_use]
    pub(crate) fn value(&self, x: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, c| sum * x + c)
    }

    /// `Σ |c_i| (1 + i)`: an upper bound of values and slopes on −1..=1.
    #[must_use]
    pub(crate) fn magnitude(&self) -> f64 {
        let terms = self.0.iter().enumerate();
        terms.map(|(i, c)| c.abs() * (1.0 + i as f64)).sum()
    }

    /// Roundings of its value in f32 for an argument of at most this size that is off by one of them: two for each multiplication and
    /// sum of Horner's scheme, and one for each coefficient.
    #[must_use]
    pub(crate) fn roundings(&self, size: f64) -> f64 {
        let terms = self.0.iter().enumerate().map(|(i, c)| {
            let degree = i as f64;
            let slope = degree * size.powi(i as i32 - 1);
            c.abs() * ((2.0 * degree + 3.0) * size.powi(i as i32) + if i > 0 { slope } else { 0.0 })
        });
        terms.sum()
    }

    /// Its coefficients in f32.
    #[must_use]
    pub(crate) fn single(&self) -> [f32; N] {
        self.0.map(|c| c as f32)
    }
}

/// [`Polynomial::value`] in f32.
#[inline(always)]
pub(crate) fn horner<const N: usize>(coefficients: [f32; N], x: f32) -> f32 {
    let mut sum = 0.0;
    for c in coefficients.into_iter().rev() {
        sum = sum * x + c;
    }
    sum
}

fn chebyshev<const N: usize>(x: f64) -> [f64; N] {
    let mut basis = [1.0; N];
    for i in 1..N {
        basis[i] = if i == 1 {
            x
        } else {
            2.0 * x * basis[i - 1] - basis[i - 2]
        };
    }
    basis
}

fn to_monomials<const N: usize>(series: [f64; N]) -> [f64; N] {
    let (mut below, mut current) = ([0.0; N], [0.0; N]);
    let mut sum = [0.0; N];
    for (degree, weight) in series.into_iter().enumerate() {
        let mut next = [0.0; N];
        match degree {
            0 => next[0] = 1.0,
            1 => next[1] = 1.0,
            _ => {
                for i in 0..N {
                    let shifted = if i > 0 { current[i - 1] } else { 0.0 };
                    next[i] = 2.0 * shifted - below[i];
                }
            }
        }
        for i in 0..N {
            sum[i] += weight * next[i];
        }
        (below, current) = (current, next);
    }
    sum
}

/// Gaussian elimination with pivots; undetermined unknowns are 0.
fn solve<const N: usize>(mut matrix: [[f64; N]; N], mut right: [f64; N]) -> [f64; N] {
    for column in 0..N {
        let pivot = (column..N)
            .max_by(|&i, &j| matrix[i][column].abs().total_cmp(&matrix[j][column].abs()))
            .unwrap_or(column);
        matrix.swap(column, pivot);
        right.swap(column, pivot);
        if matrix[column][column] == 0.0 {
            continue;
        }
        for row in column + 1..N {
            let factor = matrix[row][column] / matrix[column][column];
            for k in column..N {
                matrix[row][k] -= factor * matrix[column][k];
            }
            right[row] -= factor * right[column];
        }
    }
    let mut solution = [0.0; N];
    for row in (0..N).rev() {
        let known: f64 = (row + 1..N).map(|k| matrix[row][k] * solution[k]).sum();
        if matrix[row][row] != 0.0 {
            solution[row] = (right[row] - known) / matrix[row][row];
        }
    }
    solution
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fit_returns_the_polynomial_that_its_samples_come_from() {
        let exact = Polynomial([0.3, -2.0, 0.5, 4.0, -1.5]);
        let samples = (0..9).map(|k| {
            let x = -1.0 + f64::from(k) / 4.0;
            [x, exact.value(x), 1.0 + x * x]
        });
        let fitted = Polynomial::<5>::fit(samples);
        for (c, expected) in fitted.0.iter().zip(exact.0) {
            assert!((c - expected).abs() < 1e-12, "{fitted:?}");
        }
        for x in [-1.0, 0.2, 0.9] {
            let single = horner(exact.single(), x as f32);
            assert!((f64::from(single) - exact.value(x)).abs() < 1e-6);
        }
    }
}
