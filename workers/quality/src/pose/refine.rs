//! Local refinement of a pose: damped Gauss-Newton steps (Levenberg and Marquardt) on Sampson's distance of the inliers.

use imaging::vector::{DVec3, vec3};

use super::matrix::{Matrix, apply, cross_matrix, multiply, rotation};
use super::rays::{RayPair, RelativePose};

/// Most steps tried.
const STEPS: usize = 20;
/// Damping of the first step relative to the diagonal, and its factor after a step that does not lower the cost.
const DAMPING: f64 = 1e-4;
const MORE_DAMPING: f64 = 10.0;
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
    mut cost: impl FnMut(&RelativePose) -> f64,
) -> (RelativePose, f64) {
    let mut best = (start, cost(&start));
    let mut damping = DAMPING;
    let mut equations = NormalEquations::new(&start, pairs, limit_square);
    for _ in 0..STEPS {
        let Some(pose) = equations.step(&best.0, damping) else {
            break;
        };
        let lower = cost(&pose);
        if lower < best.1 {
            let is_last = best.1 - lower <= LEAST_GAIN * best.1;
            best = (pose, lower);
            if is_last {
                break;
            }
            damping /= MORE_DAMPING;
            equations = NormalEquations::new(&pose, pairs, limit_square);
        } else {
            damping *= MORE_DAMPING;
        }
    }
    best
}

/// Steps end when one lowers the cost by less than this share.
const LEAST_GAIN: f64 = 1e-6;

/// Normal equations of the inliers.
struct NormalEquations {
    matrix: [[f64; UNKNOWNS]; UNKNOWNS],
    right: [f64; UNKNOWNS],
}

impl NormalEquations {
    fn new(pose: &RelativePose, pairs: &[RayPair], limit_square: f64) -> Self {
        let t = pose.translation;
        let (first, second) = tangents(t);
        let mut matrix = [[0.0; UNKNOWNS]; UNKNOWNS];
        let mut right = [0.0; UNKNOWNS];
        for pair in pairs {
            // With u = R q the constraint is q' · (t × u), and the squared norm |t × u|² + |t × q'|².
            let (u, q) = (apply(&pose.rotation, pair.previous), pair.current);
            let constraint = q.dot(t.cross(u));
            let (along_u, along_q) = (t.dot(u), t.dot(q));
            let square = 2.0 - along_u * along_u - along_q * along_q;
            if square <= 0.0 || constraint * constraint > limit_square * square {
                continue;
            }
            let norm = square.sqrt();
            let distance = constraint / norm;
            // Derivatives of the distance by a rotation of u and by t.
            let share = distance / square;
            let by_turn = u.cross(q.cross(t)) * (1.0 / norm) + u.cross(t) * (along_u * share);
            let by_shift = u.cross(q) * (1.0 / norm) + (u * along_u + q * along_q) * share;
            let row = [
                by_turn.x,
                by_turn.y,
                by_turn.z,
                by_shift.dot(first),
                by_shift.dot(second),
            ];
            for i in 0..UNKNOWNS {
                right[i] -= row[i] * distance;
                for j in 0..UNKNOWNS {
                    matrix[i][j] += row[i] * row[j];
                }
            }
        }
        Self { matrix, right }
    }

    /// The pose after a step. `None` if the inliers do not determine it.
    fn step(&self, pose: &RelativePose, damping: f64) -> Option<RelativePose> {
        let mut matrix = self.matrix;
        for (i, row) in matrix.iter_mut().enumerate() {
            row[i] *= 1.0 + damping;
        }
        Some(moved_pose(pose, solve(matrix, self.right)?))
    }
}

/// The pose after a small rotation and a shift along the tangents.
fn moved_pose(pose: &RelativePose, [x, y, z, u, v]: [f64; UNKNOWNS]) -> RelativePose {
    let (first, second) = tangents(pose.translation);
    RelativePose {
        rotation: multiply(&rotation(vec3(x, y, z) * 0.5), &pose.rotation),
        translation: (pose.translation + first * u + second * v).normalized(),
    }
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

    /// Differences of the distance over a millionth of a radian.
    #[test]
    fn derivatives_agree_with_differences() {
        let (pairs, truth) = synthetic_pairs(Scene::Cloud, 4, 1, 0.01);
        let pose = RelativePose {
            translation: truth.translation.normalized(),
            ..truth
        };
        let distance = |pose: &RelativePose| {
            let (u, q) = (apply(&pose.rotation, pairs[0].previous), pairs[0].current);
            let across = [pose.translation.cross(u), pose.translation.cross(q)];
            q.dot(across[0]) / (across[0].dot(across[0]) + across[1].dot(across[1])).sqrt()
        };
        // One pair has the gradient g: the matrix is g gᵀ and the right side -g d.
        let equations = NormalEquations::new(&pose, &pairs, 1.0);
        for unknown in 0..UNKNOWNS {
            let moved = |step: f64| {
                let mut shift = [0.0; UNKNOWNS];
                shift[unknown] = step;
                distance(&moved_pose(&pose, shift))
            };
            let slope = (moved(1e-6) - moved(-1e-6)) / 2e-6;
            let expected = -slope * distance(&pose);
            assert!((equations.right[unknown] - expected).abs() < 1e-9, "{unknown}");
            assert!(
                (equations.matrix[unknown][unknown] - slope * slope).abs() < 1e-7,
                "{unknown}"
            );
        }
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
