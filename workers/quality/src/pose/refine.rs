//! Local refinement of a pose: Gauss-Newton steps on Sampson's distance of the inliers.

use imaging::vector::{DVec3, vec3};

use super::matrix::{Matrix, apply, cross_matrix, multiply, rotation};
use super::rays::{RayPair, RelativePose};

/// Most steps; each must lower the cost.
const STEPS: usize = 10;
/// Unknowns: a small rotation and a shift of the unit translation along two tangents.
const UNKNOWNS: usize = 5;

/// `[t]× R`.
pub(crate) fn essential_matrix(pose: &RelativePose) -> Matrix {
    multiply(&cross_matrix(pose.translation), &pose.rotation)
}

/// Steps from a pose as long as they lower the cost, which is a sum over all pairs with outliers truncated.
pub(crate) fn refine(
    start: RelativePose,
    pairs: &[RayPair],
    limit_square: f64,
    cost: impl Fn(&RelativePose) -> f64,
) -> (RelativePose, f64) {
    let mut best = (start, cost(&start));
    for _ in 0..STEPS {
        let Some(pose) = step(&best.0, pairs, limit_square) else {
            break;
        };
        let lower = cost(&pose);
        if lower.is_nan() || lower >= best.1 {
            break;
        }
        best = (pose, lower);
    }
    best
}

/// One step over the inliers. `None` if they do not determine it.
fn step(pose: &RelativePose, pairs: &[RayPair], limit_square: f64) -> Option<RelativePose> {
    let (e, t) = (essential_matrix(pose), pose.translation);
    let (first, second) = tangents(t);
    let mut normal = [[0.0; UNKNOWNS]; UNKNOWNS];
    let mut right = [0.0; UNKNOWNS];
    for pair in pairs {
        let (forward, back) = (apply(&e, pair.previous), apply_transposed(&e, pair.current));
        let constraint = pair.current.dot(forward);
        let norm = forward.dot(forward) + back.dot(back);
        if norm == 0.0 || constraint * constraint > limit_square * norm {
            continue;
        }
        // The derivatives of q' · (t × u), u = R q, by a rotation of u and by t.
        let turned = apply(&pose.rotation, pair.previous);
        let by_turn = turned.cross(pair.current.cross(t));
        let by_shift = turned.cross(pair.current);
        let row = [
            by_turn.x,
            by_turn.y,
            by_turn.z,
            by_shift.dot(first),
            by_shift.dot(second),
        ];
        for i in 0..UNKNOWNS {
            right[i] -= row[i] * constraint / norm;
            for j in 0..UNKNOWNS {
                normal[i][j] += row[i] * row[j] / norm;
            }
        }
    }
    let [x, y, z, u, v] = solve(normal, right)?;
    Some(RelativePose {
        rotation: multiply(&rotation(vec3(x, y, z) * 0.5), &pose.rotation),
        translation: (t + first * u + second * v).normalized(),
    })
}

fn apply_transposed(a: &Matrix, v: DVec3) -> DVec3 {
    DVec3::from(a[0]) * v.x + DVec3::from(a[1]) * v.y + DVec3::from(a[2]) * v.z
}

/// Two unit vectors at right angles to a unit vector and each other.
fn tangents(t: DVec3) -> (DVec3, DVec3) {
    let axis = if t.x.abs() < 0.6 {
        vec3(1.0, 0.0, 0.0)
    } else {
        vec3(0.0, 1.0, 0.0)
    };
    let first = t.cross(axis).normalized();
    (first, t.cross(first))
}

/// Solves symmetric equations by Cholesky's factors. `None` unless the matrix is positive definite.
fn solve(mut a: [[f64; UNKNOWNS]; UNKNOWNS], mut b: [f64; UNKNOWNS]) -> Option<[f64; UNKNOWNS]> {
    // Relative damping: directions that the inliers do not determine stay.
    let trace: f64 = (0..UNKNOWNS).map(|i| a[i][i]).sum();
    for (i, row) in a.iter_mut().enumerate() {
        row[i] += 1e-12 * trace;
    }
    for j in 0..UNKNOWNS {
        for i in j..UNKNOWNS {
            let sum: f64 = (0..j).map(|k| a[i][k] * a[j][k]).sum();
            let rest = a[i][j] - sum;
            if i > j {
                a[i][j] = rest / a[j][j];
            } else if rest > 0.0 {
                a[j][j] = rest.sqrt();
            } else {
                return None;
            }
        }
    }
    for i in 0..UNKNOWNS {
        let sum: f64 = (0..i).map(|k| a[i][k] * b[k]).sum();
        b[i] = (b[i] - sum) / a[i][i];
    }
    for i in (0..UNKNOWNS).rev() {
        let sum: f64 = (i + 1..UNKNOWNS).map(|k| a[k][i] * b[k]).sum();
        b[i] = (b[i] - sum) / a[i][i];
    }
    b.iter().all(|value| value.is_finite()).then_some(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::matrix::{rotation_angle_deg, transpose};
    use crate::pose::rays::tests::{Scene, synthetic_pairs};
    use crate::pose::rays::{RayLists, square_distances};

    #[test]
    fn a_disturbed_pose_returns_to_the_truth() {
        let (pairs, truth) = synthetic_pairs(Scene::Cloud, 4, 60, 0.0);
        let disturbed = RelativePose {
            rotation: multiply(&rotation(vec3(0.01, -0.008, 0.005)), &truth.rotation),
            translation: (truth.translation.normalized() + vec3(0.05, 0.02, -0.04)).normalized(),
        };
        let rays = RayLists::new(&pairs);
        let cost = |pose: &RelativePose| {
            let mut squares = vec![0.0; pairs.len()];
            square_distances(&rays, &essential_matrix(pose), &mut squares);
            squares.iter().sum::<f64>()
        };
        let (found, least) = refine(disturbed, &pairs, 1.0, cost);
        assert!(least < 1e-20 && cost(&disturbed) > 1e-4);
        let turn = multiply(&transpose(&found.rotation), &truth.rotation);
        assert!(rotation_angle_deg(&turn) < 1e-6);
        assert!((found.translation - truth.translation.normalized()).length() < 1e-6);
    }

    #[test]
    fn no_inliers_leave_the_pose() {
        let (_, truth) = synthetic_pairs(Scene::Cloud, 4, 1, 0.0);
        assert_eq!(refine(truth, &[], 1.0, |_| 0.0), (truth, 0.0));
    }

    #[test]
    fn symmetric_equations_are_solved() {
        let mut a = [[0.5; UNKNOWNS]; UNKNOWNS];
        for (i, row) in a.iter_mut().enumerate() {
            row[i] = 2.0 + i as f64;
        }
        let x = [1.0, -2.0, 0.5, 3.0, -1.5];
        let b = a.map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum());
        let found = solve(a, b).unwrap();
        assert!(found.iter().zip(x).all(|(found, x)| (found - x).abs() < 1e-9));
        assert_eq!(solve([[0.0; UNKNOWNS]; UNKNOWNS], b), None);
    }
}
