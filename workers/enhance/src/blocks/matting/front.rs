//! Dense symmetric matrix with partial elimination.

use imaging::vectorized;

/// Columns eliminated between updates of the rest of the matrix.
const PANEL: usize = 32;

/// The lower half of a symmetric positive definite matrix: first the rows to eliminate, then the surrounding ones.
pub(super) struct Front {
    own: usize,
    size: usize,
    /// StepRows-major; elements above the diagonal are never read.
    rows: Vec<f64>,
}

impl Front {
    pub(super) fn new(own: usize, around: usize) -> Self {
        let size = own + around;
        Self {
            own,
            size,
            rows: vec![0.0; size * size],
        }
    }

    /// Adds to the element of a row and a column, in either order.
    pub(super) fn add(&mut self, a: usize, b: usize, value: f64) {
        self.rows[a.max(b) * self.size + a.min(b)] += value;
    }

    /// Replaces the first columns by those of the Cholesky factor, and the rest by its Schur complement.
    pub(super) fn eliminate(&mut self) {
        let mut transposed = vec![0.0; PANEL * self.size];
        for start in (0..self.own).step_by(PANEL) {
            let end = (start + PANEL).min(self.own);
            vectorized!(factor(&mut self.rows, self.size, start, end));
            for row in end..self.size {
                for column in start..end {
                    transposed[(column - start) * self.size + row] = self.rows[row * self.size + column];
                }
            }
            vectorized!(update(&mut self.rows, &transposed, self.size, start, end));
        }
    }

    /// The eliminated columns of all rows, and the remaining rows and columns.
    pub(super) fn into_parts(self) -> (Vec<f64>, Vec<f64>) {
        let all = self.rows.chunks_exact(self.size.max(1));
        let columns = all.clone().flat_map(|row| &row[..self.own]).copied().collect();
        let left = all
            .skip(self.own)
            .flat_map(|row| &row[self.own..])
            .copied()
            .collect();
        (columns, left)
    }
}

/// Columns `start..end` of the factor, in all rows.
#[inline(always)]
fn factor(rows: &mut [f64], size: usize, start: usize, end: usize) {
    for row in start..size {
        let (above, own) = rows.split_at_mut(row * size);
        let own = &mut own[..size];
        for column in start..end.min(row + 1) {
            let taken: f64 = if column < row {
                let other = &above[column * size..][start..column];
                own[start..column].iter().zip(other).map(|(a, b)| a * b).sum()
            } else {
                own[start..column].iter().map(|a| a * a).sum()
            };
            own[column] -= taken;
            own[column] = if column < row {
                own[column] / above[column * size + column]
            } else {
                own[column].sqrt()
            };
        }
    }
}

/// Subtracts the products of columns `start..end` from all later elements.
#[inline(always)]
fn update(rows: &mut [f64], transposed: &[f64], size: usize, start: usize, end: usize) {
    for row in end..size {
        let own = &mut rows[row * size..][..=row];
        let (known, left) = own.split_at_mut(end);
        let known = &known[start..];
        let length = left.len();
        let column = |i: usize| &transposed[i * size + end..][..length];
        let whole = known.len() / 4 * 4;
        for i in (0..whole).step_by(4) {
            let (a, b, c, d) = (column(i), column(i + 1), column(i + 2), column(i + 3));
            let [l, m, n, o] = [known[i], known[i + 1], known[i + 2], known[i + 3]];
            for j in 0..length {
                left[j] -= l * a[j] + m * b[j] + n * c[j] + o * d[j];
            }
        }
        for i in whole..known.len() {
            for (value, other) in left.iter_mut().zip(column(i)) {
                *value -= known[i] * other;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factor_times_its_transpose_is_the_matrix() {
        for (own, around) in [(1, 0), (3, 2), (40, 7), (70, 33)] {
            let size = own + around;
            let element = |i: usize, j: usize| {
                let near = 1.0 / (1.0 + i.abs_diff(j) as f64);
                near + if i == j { 2.0 + (i % 5) as f64 } else { 0.0 }
            };
            let mut front = Front::new(own, around);
            for i in 0..size {
                for j in 0..=i {
                    front.add(j, i, element(i, j));
                }
            }
            front.eliminate();
            let (columns, left) = front.into_parts();
            let entry = |i: usize, k: usize| if k <= i { columns[i * own + k] } else { 0.0 };
            for i in 0..size {
                for j in 0..=i {
                    let product: f64 = (0..own).map(|k| entry(i, k) * entry(j, k)).sum();
                    let rest = match i >= own && j >= own {
                        true => left[(i - own) * around + j - own],
                        false => 0.0,
                    };
                    assert!((product + rest - element(i, j)).abs() < 1e-12, "{own} {i} {j}");
                }
            }
        }
    }
}
