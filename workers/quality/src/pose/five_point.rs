//! Essential matrices from five pairs of rays (Nistér 2004, "An efficient solution to the five-point relative pose
//! problem").
//!
//! `q'ᵀ E q = 0` for each pair leaves `E = x X + y Y + z Z + W`. `det E = 0` and `2 E Eᵀ E - tr(E Eᵀ) E = 0` are ten cubic
//! equations; elimination of ten monomials leaves a polynomial of degree ten in z.

use super::cubic::{Cubic, Linear, Quadratic, add_linear_product, add_product};
use super::matrix::Matrix;
use super::null_space::find_null_space;
use super::polynomial::{Polynomial, find_roots};
use super::rays::RayPair;

/// At most ten essential matrices, of norm 1 up to the scale of the solution; empty for degenerate pairs.
pub(crate) fn solve_five_points(pairs: &[RayPair; 5]) -> Vec<Matrix> {
    let rows = pairs.map(|pair| {
        let (q, p): ([f64; 3], [f64; 3]) = (pair.current.into(), pair.previous.into());
        std::array::from_fn(|i| q[i / 3] * p[i % 3])
    });
    let basis = find_null_space(&rows);
    let Some(reduced) = eliminate(build_constraints(&basis)) else {
        return Vec::new();
    };
    let in_z = [0, 2, 4].map(|row| subtract_times_z(&reduced[row], &reduced[row + 1]));
    let roots = find_roots(&determinant(&in_z));
    let matrices = roots.into_iter().filter_map(|z| {
        let [x, y] = solve_xy(&in_z, z)?;
        let scale = 1.0 / (x * x + y * y + z * z + 1.0).sqrt();
        let entry = |i: usize| scale * (x * basis[0][i] + y * basis[1][i] + z * basis[2][i] + basis[3][i]);
        let matrix = [0, 3, 6].map(|i| [entry(i), entry(i + 1), entry(i + 2)]);
        matrix
            .iter()
            .flatten()
            .all(|value| value.is_finite())
            .then_some(matrix)
    });
    matrices.collect()
}

/// The ten cubic equations.
fn build_constraints(basis: &[[f64; 9]; 4]) -> [Cubic; 10] {
    // The entries of E as linear polynomials.
    let e: [[Linear; 3]; 3] = [0, 1, 2].map(|i| [0, 1, 2].map(|j| [0, 1, 2, 3].map(|k| basis[k][3 * i + j])));
    // E Eᵀ, and half its trace subtracted from the diagonal.
    let mut product: [[Quadratic; 3]; 3] = [[[0.0; 10]; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            for k in 0..3 {
                add_linear_product(&mut product[i][j], 1.0, &e[i][k], &e[j][k]);
            }
        }
    }
    let half_trace: Quadratic =
        std::array::from_fn(|i| 0.5 * (product[0][0][i] + product[1][1][i] + product[2][2][i]));
    for (i, row) in product.iter_mut().enumerate() {
        for (entry, half) in row[i].iter_mut().zip(half_trace) {
            *entry -= half;
        }
    }
    let mut equations = [[0.0; 20]; 10];
    for i in 0..3 {
        for j in 0..3 {
            for k in 0..3 {
                add_product(&mut equations[3 * i + j], 1.0, &product[i][k], &e[k][j]);
            }
        }
    }
    // The determinant by its first row.
    for (i, [j, k]) in [[1, 2], [2, 0], [0, 1]].into_iter().enumerate() {
        let mut minor = [0.0; 10];
        add_linear_product(&mut minor, 1.0, &e[1][j], &e[2][k]);
        add_linear_product(&mut minor, -1.0, &e[1][k], &e[2][j]);
        add_product(&mut equations[9], 1.0, &minor, &e[0][i]);
    }
    equations
}

/// Smallest pivot relative to the largest coefficient.
const LEAST_PIVOT: f64 = 1e-12;

/// Gauss-Jordan elimination of the first ten monomials with partial pivoting: the remaining ten coefficients of the rows
/// of x²z, x², y²z, y², xyz and xy. `None` if the equations are dependent.
fn eliminate(mut rows: [Cubic; 10]) -> Option<[[f64; 10]; 6]> {
    let largest = rows
        .iter()
        .flatten()
        .fold(0.0f64, |most, value| most.max(value.abs()));
    for column in 0..10 {
        let pivot = (column..10).max_by(|&a, &b| rows[a][column].abs().total_cmp(&rows[b][column].abs()))?;
        rows.swap(column, pivot);
        if rows[column][column].abs() <= LEAST_PIVOT * largest {
            return None;
        }
        let scale = 1.0 / rows[column][column];
        let own = rows[column].map(|value| value * scale);
        for (other, row) in rows.iter_mut().enumerate() {
            let factor = row[column];
            if other != column && factor != 0.0 {
                for (value, own) in row[column..].iter_mut().zip(&own[column..]) {
                    *value -= factor * own;
                }
            }
        }
        rows[column] = own;
    }
    Some([4, 5, 6, 7, 8, 9].map(|row| std::array::from_fn(|i| rows[row][10 + i])))
}

/// Polynomials in z that are the factors of x, y and 1 in an equation, the constant first.
type InZ = [[f64; 5]; 3];

/// The row of a monomial with z minus z times the row of the one without: the monomial cancels. The coefficients are those
/// of xz², xz, x, yz², yz, y, z³, z², z and 1.
fn subtract_times_z(with: &[f64; 10], without: &[f64; 10]) -> InZ {
    let factor = |first: usize| {
        [
            with[first + 2],
            with[first + 1] - without[first + 2],
            with[first] - without[first + 1],
            -without[first],
            0.0,
        ]
    };
    let free = [
        with[9],
        with[8] - without[9],
        with[7] - without[8],
        with[6] - without[7],
        -without[6],
    ];
    [factor(0), factor(3), free]
}

/// The determinant of the three equations' factors.
fn determinant(rows: &[InZ; 3]) -> Polynomial {
    let mut sum = [0.0; 11];
    let signed = [
        ([0, 1, 2], 1.0),
        ([1, 2, 0], 1.0),
        ([2, 0, 1], 1.0),
        ([0, 2, 1], -1.0),
        ([1, 0, 2], -1.0),
        ([2, 1, 0], -1.0),
    ];
    for (columns, sign) in signed {
        let [a, b, c] = [0, 1, 2].map(|row| &rows[row][columns[row]]);
        for (i, a) in a.iter().enumerate() {
            for (j, b) in b.iter().enumerate() {
                for (k, c) in c.iter().enumerate() {
                    // Products beyond z¹⁰ have a factor 0: only one of the three has degree four.
                    if i + j + k <= 10 {
                        sum[i + j + k] += sign * a * b * c;
                    }
                }
            }
        }
    }
    sum
}

/// x and y at a root z: the direction (x, y, 1) orthogonal to two of the three equations.
fn solve_xy(rows: &[InZ; 3], z: f64) -> Option<[f64; 2]> {
    let values = rows.map(|row| {
        let at_z = row.map(|factor| factor.iter().rev().fold(0.0, |sum, c| sum * z + c));
        imaging::vector::DVec3::from(at_z)
    });
    let crosses = [
        values[0].cross(values[1]),
        values[1].cross(values[2]),
        values[2].cross(values[0]),
    ];
    let best = crosses
        .into_iter()
        .max_by(|a, b| a.z.abs().total_cmp(&b.z.abs()))?;
    (best.z != 0.0).then(|| [best.x / best.z, best.y / best.z])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::matrix::{cross_matrix, multiply};
    use crate::pose::rays::tests::{Scene, synthetic_pairs};

    /// The distance of the nearest solution from the truth, both of norm 1.
    fn distance_from_truth(scene: Scene, seed: u64) -> f64 {
        let (pairs, truth) = synthetic_pairs(scene, seed, 5, 0.0);
        let five: [RayPair; 5] = pairs.try_into().unwrap();
        let e = multiply(&cross_matrix(truth.translation), &truth.rotation);
        let norm = e.iter().flatten().map(|value| value * value).sum::<f64>().sqrt();
        let mut nearest = f64::INFINITY;
        for found in solve_five_points(&five) {
            for sign in [-norm, norm] {
                let pairs = found.iter().flatten().zip(e.iter().flatten());
                let square: f64 = pairs.map(|(a, b)| (a - b / sign).powi(2)).sum();
                nearest = nearest.min(square.sqrt());
            }
        }
        nearest
    }

    #[test]
    fn the_true_essential_matrix_is_among_the_solutions() {
        for scene in [Scene::Cloud, Scene::Plane] {
            let mut distances: Vec<f64> = (0..200).map(|seed| distance_from_truth(scene, seed)).collect();
            distances.sort_by(f64::total_cmp);
            // Some five points are near a degenerate configuration and lose digits, more often on a plane.
            let (median, most) = (distances[100], distances[180]);
            assert!(median < 1e-9 && most < 1e-3, "{scene:?}: {median} {most}");
        }
    }

    #[test]
    fn equal_rays_have_no_solution_or_finite_ones() {
        let (pairs, _) = synthetic_pairs(Scene::Cloud, 3, 1, 0.0);
        for matrix in solve_five_points(&[pairs[0]; 5]) {
            assert!(matrix.iter().flatten().all(|value| value.is_finite()));
        }
    }
}
