//! Position and orientation of a camera in the world of a scene.

use imaging::vector::{DVec3, vec3};

/// Position and axes of a camera in the world: meters, z up, the ground at z = 0.
///
/// The axes are those of the picture: x right, y down, z ahead; orthonormal and right-handed. A point `p` of the world has
/// the camera coordinates `(right·(p-c), down·(p-c), ahead·(p-c))`, c the position (Hartley and Zisserman 2004,
/// section 6.1, with R's rows written as three vectors).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraPose {
    /// The center of projection.
    pub position_m: DVec3,
    /// Direction of growing columns.
    pub right: DVec3,
    /// Direction of growing rows.
    pub down: DVec3,
    /// The optical axis.
    pub ahead: DVec3,
}

impl CameraPose {
    /// A camera at `eye` that looks at `target`, level but for `roll` radians about its optical axis (positive: the picture of
    /// the world turns clockwise). Looking straight up or down, the world's x axis is to the right. `target` must differ from
    /// `eye`.
    #[must_use]
    pub fn looking(eye: DVec3, target: DVec3, roll: f64) -> Self {
        let ahead = (target - eye).normalized();
        let upright = if ahead.z.abs() < 0.999 {
            vec3(0.0, 0.0, 1.0)
        } else {
            vec3(1.0, 0.0, 0.0).cross(ahead)
        };
        let level = ahead.cross(upright).normalized();
        let (sin, cos) = libm::sincos(roll);
        let right = level * cos + ahead.cross(level) * sin;
        Self {
            position_m: eye,
            right,
            down: ahead.cross(right),
            ahead,
        }
    }

    /// The 4x4 matrix, by rows, from camera coordinates to the world's.
    #[must_use]
    pub fn world_from_camera(&self) -> [[f64; 4]; 4] {
        let columns = [self.right, self.down, self.ahead, self.position_m];
        let [x, y, z] = [columns.map(|v| v.x), columns.map(|v| v.y), columns.map(|v| v.z)];
        [x, y, z, [0.0, 0.0, 0.0, 1.0]]
    }

    /// Camera coordinates of a point of the world, in meters: right, down, ahead.
    #[must_use]
    pub fn to_camera(&self, point: DVec3) -> DVec3 {
        let away = point - self.position_m;
        [self.right, self.down, self.ahead]
            .map(|axis| axis.dot(away))
            .into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_orthonormal_and_right_handed_even_straight_down() {
        for target in [
            vec3(1.0, 2.0, 0.0),
            vec3(0.0, 0.0, -4.0),
            vec3(0.0, 0.0, 9.0),
            vec3(1e-4, 0.0, -1.0),
        ] {
            let pose = CameraPose::looking(vec3(0.0, 0.0, 1.0), target, 0.3);
            for (a, b) in [
                (pose.right, pose.down),
                (pose.down, pose.ahead),
                (pose.ahead, pose.right),
            ] {
                assert!(a.dot(b).abs() < 1e-12 && (a.length() - 1.0).abs() < 1e-12);
            }
            assert!(pose.right.cross(pose.down).dot(pose.ahead) > 0.999_999);
        }
    }

    #[test]
    fn the_matrix_undoes_camera_coordinates() {
        let pose = CameraPose::looking(vec3(1.0, -2.0, 3.0), vec3(4.0, 0.0, 2.0), -0.4);
        let point: [f64; 3] = [0.3, 7.0, -1.2];
        let [x, y, z] = pose.to_camera(point.into()).into();
        let back = pose
            .world_from_camera()
            .map(|row| row[0] * x + row[1] * y + row[2] * z + row[3]);
        assert!((0..3).all(|i| (back[i] - point[i]).abs() < 1e-12) && back[3] == 1.0);
    }
}
