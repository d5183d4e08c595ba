//! Error of an estimated pose.

use super::matrix::{multiply, rotation_angle_deg, transpose};
use super::rays::RelativePose;

/// Error of a relative pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseError {
    /// Angle between the rotations, 0..=180 degrees.
    pub deg: f64,
    /// Distance of the translations, 0..=2 |t_true| meters.
    pub m: f64,
}

/// The angle of `R_estᵀ R_true` and `| t_est |t_true| / |t_est| - t_true |`: matches determine a translation up to its
/// length, so the estimate has the true length. Without an estimate both errors are the largest possible.
#[must_use]
pub fn pose_error(estimate: Option<&RelativePose>, truth: &RelativePose) -> PoseError {
    let length = truth.translation.length();
    let Some(estimate) = estimate else {
        return PoseError {
            deg: 180.0,
            m: 2.0 * length,
        };
    };
    let turn = multiply(&transpose(&estimate.rotation), &truth.rotation);
    let scaled = estimate.translation * (length / estimate.translation.length());
    PoseError {
        deg: rotation_angle_deg(&turn),
        m: (scaled - truth.translation).length(),
    }
}

#[cfg(test)]
mod tests {
    use imaging::vector::vec3;

    use super::*;
    use crate::pose::matrix::rotation;

    #[test]
    fn errors_are_the_angle_and_the_distance_at_the_true_length() {
        // A quarter turn, and a translation at right angles to the true one.
        let truth = RelativePose {
            rotation: rotation(vec3(0.0, 0.0, 0.0)),
            translation: vec3(0.0, 0.0, 0.5),
        };
        let estimate = RelativePose {
            rotation: rotation(vec3(0.0, 1.0, 0.0)),
            translation: vec3(1.0, 0.0, 0.0),
        };
        let error = pose_error(Some(&estimate), &truth);
        assert!((error.deg - 90.0).abs() < 1e-12 && (error.m - 0.5 * 2f64.sqrt()).abs() < 1e-12);
        let itself = RelativePose {
            translation: vec3(0.0, 0.0, 1.0),
            ..truth
        };
        assert_eq!(pose_error(Some(&itself), &truth), PoseError { deg: 0.0, m: 0.0 });
        assert_eq!(pose_error(None, &truth), PoseError { deg: 180.0, m: 1.0 });
    }
}
