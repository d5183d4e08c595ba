//! Pairs of rays to the same point.

use imaging::vector::DVec3;

use super::matrix::Matrix;

/// Unit rays to a point in camera axes: right, down, ahead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayPair {
    /// In the previous frame.
    pub previous: DVec3,
    /// In the current frame.
    pub current: DVec3,
}

/// The previous camera seen from the current one: `x_current = R x_previous + t`, in camera axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelativePose {
    /// R, row by row.
    pub rotation: Matrix,
    /// t in meters; of length 1 in an estimate, whose scale is unknown.
    pub translation: DVec3,
}

/// Components of many pairs, one after the other, for vector loops.
pub(crate) struct RayLists {
    pub(crate) previous: [Vec<f64>; 3],
    pub(crate) current: [Vec<f64>; 3],
}

impl RayLists {
    pub(crate) fn new(pairs: &[RayPair]) -> Self {
        let list = |component: fn(&RayPair) -> f64| pairs.iter().map(component).collect();
        Self {
            previous: [
                list(|pair| pair.previous.x),
                list(|pair| pair.previous.y),
                list(|pair| pair.previous.z),
            ],
            current: [
                list(|pair| pair.current.x),
                list(|pair| pair.current.y),
                list(|pair| pair.current.z),
            ],
        }
    }
}

/// Sampson's squared distance in rad² of each pair from the epipolar constraint of E, `(q'ᵀ E q)² / (|E q|² + |Eᵀ q'|²)`.
#[inline(always)]
pub(crate) fn square_distances(rays: &RayLists, e: &Matrix, squares: &mut [f64]) {
    let count = squares.len();
    let [ax, ay, az] = rays.previous.each_ref().map(|list| &list[..count]);
    let [bx, by, bz] = rays.current.each_ref().map(|list| &list[..count]);
    for i in 0..count {
        let (a, b) = ([ax[i], ay[i], az[i]], [bx[i], by[i], bz[i]]);
        let mut forward = [0.0; 3];
        let mut back = [0.0; 3];
        for row in 0..3 {
            forward[row] = e[row][0] * a[0] + e[row][1] * a[1] + e[row][2] * a[2];
            back[row] = e[0][row] * b[0] + e[1][row] * b[1] + e[2][row] * b[2];
        }
        let constraint = b[0] * forward[0] + b[1] * forward[1] + b[2] * forward[2];
        let mut norm = f64::MIN_POSITIVE;
        for row in 0..3 {
            norm += forward[row] * forward[row] + back[row] * back[row];
        }
        squares[i] = constraint * constraint / norm;
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use imaging::random::Stream;
    use imaging::vector::vec3;

    use super::*;
    use crate::pose::matrix::{apply, rotation};

    #[derive(Debug, Clone, Copy, PartialEq)]
    pub(crate) enum Scene {
        /// Points at 2 to 6 m.
        Cloud,
        /// A slanted plane.
        Plane,
        /// A cloud and a camera that only rotates.
        Rotation,
    }

    /// Rays to random points of a scene and the true pose, with Gaussian noise of `noise_rad`.
    pub(crate) fn synthetic_pairs(
        scene: Scene,
        seed: u64,
        count: usize,
        noise_rad: f64,
    ) -> (Vec<RayPair>, RelativePose) {
        let stream = Stream::stage(seed, "synthetic-pairs");
        let signed = |index: u64, element: u64| 2.0 * stream.unit(index, element) - 1.0;
        let turn = vec3(signed(0, 0), signed(0, 1), signed(0, 2)) * 0.08;
        let shift = vec3(signed(0, 3), signed(0, 4), signed(0, 5)) * 0.3;
        let truth = RelativePose {
            rotation: rotation(turn),
            translation: if scene == Scene::Rotation {
                shift * 0.0
            } else {
                shift
            },
        };
        // The sum of twelve uniform values has variance 1.
        let noise = |index: u64, element: u64| {
            noise_rad
                * ((0..12)
                    .map(|k| stream.unit(index, 100 * element + k))
                    .sum::<f64>()
                    - 6.0)
        };
        let pair = |i: u64| {
            let direction = vec3(0.7 * signed(i, 0), 0.5 * signed(i, 1), 1.0);
            let z = match scene {
                Scene::Plane => 4.0 / (1.0 + 0.3 * direction.x - 0.5 * direction.y),
                _ => 4.0 + 2.0 * signed(i, 2),
            };
            let point = direction * z;
            let seen = apply(&truth.rotation, point) + truth.translation;
            let blur = |v: DVec3, element: u64| {
                let v = v.normalized();
                (v + vec3(noise(i, element), noise(i, element + 1), noise(i, element + 2))).normalized()
            };
            RayPair {
                previous: blur(point, 1),
                current: blur(seen, 4),
            }
        };
        ((1..=count as u64).map(pair).collect(), truth)
    }

    #[test]
    fn true_pairs_have_no_distance_and_noise_has_its_angle() {
        let noise = 0.002;
        let (pairs, truth) = synthetic_pairs(Scene::Cloud, 1, 400, noise);
        let e = crate::pose::matrix::multiply(
            &crate::pose::matrix::cross_matrix(truth.translation),
            &truth.rotation,
        );
        let mean = |pairs: &[RayPair]| {
            let mut squares = vec![0.0; pairs.len()];
            square_distances(&RayLists::new(pairs), &e, &mut squares);
            squares.iter().sum::<f64>() / pairs.len() as f64
        };
        assert!(mean(&synthetic_pairs(Scene::Cloud, 1, 400, 0.0).0) < 1e-28);
        // Sampson's distance is the shift of both rays together, of one component.
        assert!((mean(&pairs).sqrt() / noise - 1.0).abs() < 0.1);
    }
}
