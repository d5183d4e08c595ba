//! Matrices of 3 × 3, row by row.

use imaging::vector::{DVec3, vec3};

/// Rows of a matrix.
pub(crate) type Matrix = [[f64; 3]; 3];

/// `A B`.
pub(crate) fn multiply(a: &Matrix, b: &Matrix) -> Matrix {
    a.map(|row| [0, 1, 2].map(|j| row[0] * b[0][j] + row[1] * b[1][j] + row[2] * b[2][j]))
}

/// `Aᵀ`.
pub(crate) fn transpose(a: &Matrix) -> Matrix {
    [0, 1, 2].map(|i| [a[0][i], a[1][i], a[2][i]])
}

/// `A v`.
#[inline(always)]
pub(crate) fn apply(a: &Matrix, v: DVec3) -> DVec3 {
    vec3(
        DVec3::from(a[0]).dot(v),
        DVec3::from(a[1]).dot(v),
        DVec3::from(a[2]).dot(v),
    )
}

/// `[v]×`, the matrix of the cross product with v.
pub(crate) fn cross_matrix(v: DVec3) -> Matrix {
    [[0.0, -v.z, v.y], [v.z, 0.0, -v.x], [-v.y, v.x, 0.0]]
}

/// The cofactors.
pub(crate) fn cofactors(a: &Matrix) -> Matrix {
    let rows = a.map(DVec3::from);
    [
        rows[1].cross(rows[2]),
        rows[2].cross(rows[0]),
        rows[0].cross(rows[1]),
    ]
    .map(Into::into)
}

/// The rotation `((1 - |a|²) I + 2 a aᵀ + 2 [a]×) / (1 + |a|²)` about a by the angle `2 atan |a|` (Cayley).
pub(crate) fn rotation(a: DVec3) -> Matrix {
    let square = a.dot(a);
    let cross = cross_matrix(a);
    let components: [f64; 3] = a.into();
    let scale = 1.0 / (1.0 + square);
    let mut rotation = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            let diagonal = if i == j { 1.0 - square } else { 0.0 };
            rotation[i][j] = (diagonal + 2.0 * components[i] * components[j] + 2.0 * cross[i][j]) * scale;
        }
    }
    rotation
}

/// The angle of a rotation in degrees, 0..=180.
pub(crate) fn rotation_angle_deg(r: &Matrix) -> f64 {
    let sine = vec3(r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]).length();
    let cosine = r[0][0] + r[1][1] + r[2][2] - 1.0;
    libm::atan2(sine, cosine).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_are_orthonormal_and_have_their_angle() {
        let axis = vec3(0.2, -0.3, 0.6);
        let r = rotation(axis);
        let product = multiply(&r, &transpose(&r));
        for i in 0..3 {
            for j in 0..3 {
                assert!((product[i][j] - f64::from(u8::from(i == j))).abs() < 1e-15);
            }
        }
        let expected = 2.0 * axis.length().atan().to_degrees();
        assert!((rotation_angle_deg(&r) - expected).abs() < 1e-12);
        assert!((apply(&r, axis) - axis).length() < 1e-15);
        // A quarter turn about z maps x to y.
        let quarter = rotation(vec3(0.0, 0.0, 1.0));
        assert!((apply(&quarter, vec3(1.0, 0.0, 0.0)) - vec3(0.0, 1.0, 0.0)).length() < 1e-15);
    }

    #[test]
    fn cofactors_are_the_adjugate_transposed() {
        let a = [[2.0, -1.0, 0.5], [0.3, 4.0, 1.0], [-2.0, 0.1, 3.0]];
        let product = multiply(&a, &transpose(&cofactors(&a)));
        assert!((product[0][0] - product[1][1]).abs() < 1e-12 && product[0][1].abs() < 1e-12);
        let v = vec3(0.4, 2.0, -1.0);
        assert_eq!(
            apply(&cross_matrix(v), vec3(3.0, 1.0, 2.0)),
            v.cross(vec3(3.0, 1.0, 2.0))
        );
    }
}
