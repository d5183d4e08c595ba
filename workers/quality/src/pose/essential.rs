//! Poses of an essential matrix `E = [t]× R`.

use imaging::vector::DVec3;

use super::matrix::{Matrix, apply, cofactors, cross_matrix, multiply, transpose};
use super::rays::{RayPair, RelativePose};

/// The four poses of an essential matrix, translations of length 1. `None` for a matrix of zeros. Closed form of Horn
/// 1990, "Recovering baseline and orientation from essential matrix": `t tᵀ = tr(E Eᵀ) I / 2 - E Eᵀ` and `|t|² R = cof E -
/// [t]× E`.
pub(crate) fn find_poses(e: &Matrix) -> Option<[RelativePose; 4]> {
    let square = multiply(e, &transpose(e));
    let half_trace = 0.5 * (square[0][0] + square[1][1] + square[2][2]);
    if half_trace.is_nan() || half_trace <= 0.0 {
        return None;
    }
    // The largest diagonal entry of t tᵀ.
    let axis = (0..3).min_by(|&a, &b| square[a][a].total_cmp(&square[b][b]))?;
    let mut column = [0, 1, 2].map(|row| -square[row][axis]);
    column[axis] += half_trace;
    let translation = DVec3::from(column).normalized();
    let scaled = translation * half_trace.sqrt();
    let (cofactors, product) = (cofactors(e), multiply(&cross_matrix(scaled), e));
    Some(
        [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(twist, sign)| RelativePose {
            rotation: [0, 1, 2]
                .map(|i| [0, 1, 2].map(|j| (cofactors[i][j] - twist * product[i][j]) / half_trace)),
            translation: translation * sign,
        }),
    )
}

/// The pose that puts the most points in front of both cameras, of equal ones the first.
pub(crate) fn choose_in_front(poses: [RelativePose; 4], pairs: &[RayPair]) -> Option<RelativePose> {
    let count = |pose: &RelativePose| pairs.iter().filter(|pair| is_in_front(pose, pair)).count();
    poses.into_iter().rev().max_by_key(count)
}

/// Whether both distances of the point nearest to both rays are positive.
fn is_in_front(pose: &RelativePose, pair: &RayPair) -> bool {
    let turned = apply(&pose.rotation, pair.previous);
    let cosine = turned.dot(pair.current);
    let (along_turned, along_current) = (turned.dot(pose.translation), pair.current.dot(pose.translation));
    // Both are divided by 1 - cos², which is not negative.
    cosine * along_current - along_turned > 0.0 && along_current - cosine * along_turned > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::matrix::rotation_angle_deg;
    use crate::pose::rays::tests::{Scene, synthetic_pairs};

    #[test]
    fn the_pose_comes_back_from_its_matrix_of_either_sign() {
        for seed in 0..50 {
            let (pairs, truth) = synthetic_pairs(Scene::Cloud, seed, 20, 0.0);
            let e = multiply(&cross_matrix(truth.translation), &truth.rotation);
            for e in [e, e.map(|row| row.map(|value| -0.3 * value))] {
                let found = choose_in_front(find_poses(&e).unwrap(), &pairs).unwrap();
                let turn = multiply(&transpose(&found.rotation), &truth.rotation);
                assert!(rotation_angle_deg(&turn) < 1e-9);
                assert!((found.translation - truth.translation.normalized()).length() < 1e-12);
            }
        }
    }

    #[test]
    fn zeros_have_no_pose() {
        assert_eq!(find_poses(&[[0.0; 3]; 3]), None);
    }
}
