//! An orthonormal basis of the vectors of nine components that are orthogonal to five given ones.

type Vector9 = [f64; 9];

/// The basis, by Householder reflections. If the five are dependent, the basis is a part of the larger null space.
pub(crate) fn find_null_space(rows: &[Vector9; 5]) -> [Vector9; 4] {
    let mut columns = *rows;
    let mut reflections = [[0.0; 9]; 5];
    for k in 0..5 {
        let tail: f64 = columns[k][k..].iter().map(|value| value * value).sum();
        let length = tail.sqrt();
        if length == 0.0 {
            continue;
        }
        // The sign avoids cancellation.
        let mut normal = [0.0; 9];
        normal[k..].copy_from_slice(&columns[k][k..]);
        normal[k] += if normal[k] < 0.0 { -length } else { length };
        let square: f64 = normal.iter().map(|value| value * value).sum();
        reflections[k] = normal.map(|value| value * (2.0 / square).sqrt());
        for column in &mut columns[k..] {
            reflect(column, &reflections[k]);
        }
    }
    [5, 6, 7, 8].map(|axis| {
        let mut basis = [0.0; 9];
        basis[axis] = 1.0;
        for normal in reflections.iter().rev() {
            reflect(&mut basis, normal);
        }
        basis
    })
}

/// `v - n (n · v)` with n of length sqrt 2.
fn reflect(vector: &mut Vector9, normal: &Vector9) {
    let along: f64 = vector.iter().zip(normal).map(|(v, n)| v * n).sum();
    for (v, n) in vector.iter_mut().zip(normal) {
        *v -= along * n;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dot(a: &Vector9, b: &Vector9) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    #[test]
    fn the_basis_is_orthonormal_and_orthogonal_to_all_rows() {
        let row = |k: usize| std::array::from_fn(|i| ((7 * k + 3) * (i + 2) * (i + k)) as f64 % 11.0 - 5.0);
        let independent = [0, 1, 2, 3, 4].map(row);
        let dependent = [row(1), row(1), row(2), [0.0; 9], row(3)];
        for rows in [independent, dependent, [[0.0; 9]; 5]] {
            let basis = find_null_space(&rows);
            for (i, one) in basis.iter().enumerate() {
                assert!(rows.iter().all(|row| dot(row, one).abs() < 1e-12));
                for (j, other) in basis.iter().enumerate() {
                    assert!((dot(one, other) - f64::from(u8::from(i == j))).abs() < 1e-14);
                }
            }
        }
    }
}
