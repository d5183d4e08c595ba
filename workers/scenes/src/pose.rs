//! Where a camera is in the world of a scene, and which way it looks.

/// Position and axes of a camera in the world: metres, z up, the ground at z = 0.
///
/// The axes are those of the picture: x right, y down, z ahead; unit vectors at right angles, right-handed. A point `p` of
/// the world has the camera coordinates `(right·(p-c), down·(p-c), ahead·(p-c))`, c the position (Hartley and Zisserman 2004,
/// section 6.1, with R's rows written as three vectors).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraPose {
    /// The centre of projection.
    pub position_m: [f64; 3],
    /// Direction of growing columns.
    pub right: [f64; 3],
    /// Direction of growing rows.
    pub down: [f64; 3],
    /// The optical axis.
    pub ahead: [f64; 3],
}

impl CameraPose {
    /// A camera at `eye` that looks at `target`, level but for `roll` radians about its optical axis (clockwise in the
    /// picture is the world). Looking straight up or down, the world's x axis is to the right. `target` must differ from `eye`.
    #[must_use]
    pub fn looking(eye: [f64; 3], target: [f64; 3], roll: f64) -> Self {
        let ahead = unit(sub(target, eye));
        let level = if ahead[2].abs() < 0.999 {
            unit(cross(ahead, [0.0, 0.0, 1.0]))
        } else {
            unit(cross(ahead, cross([1.0, 0.0, 0.0], ahead)))
        };
        let (sin, cos) = libm::sincos(roll);
        let right = add(scale(level, cos), scale(cross(ahead, level), sin));
        Self {
            position_m: eye,
            right,
            down: cross(ahead, right),
            ahead,
        }
    }

    /// The 4x4 matrix, by rows, that takes camera coordinates to the world's.
    #[must_use]
    pub fn world_from_camera(&self) -> [[f64; 4]; 4] {
        let row = |i: usize| [self.right[i], self.down[i], self.ahead[i], self.position_m[i]];
        [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
    }

    /// Camera coordinates of a point of the world, in metres: right, down, ahead.
    #[must_use]
    pub fn to_camera(&self, point: [f64; 3]) -> [f64; 3] {
        let away = sub(point, self.position_m);
        [dot(self.right, away), dot(self.down, away), dot(self.ahead, away)]
    }
}

pub(crate) fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    add(a, scale(b, -1.0))
}

pub(crate) fn scale(a: [f64; 3], by: f64) -> [f64; 3] {
    a.map(|v| v * by)
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

pub(crate) fn unit(a: [f64; 3]) -> [f64; 3] {
    scale(a, 1.0 / length(a))
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_orthonormal_and_right_handed_even_straight_down() {
        for target in [
            [1.0, 2.0, 0.0],
            [0.0, 0.0, -4.0],
            [0.0, 0.0, 9.0],
            [1e-4, 0.0, -1.0],
        ] {
            let pose = CameraPose::looking([0.0, 0.0, 1.0], target, 0.3);
            for (a, b) in [
                (pose.right, pose.down),
                (pose.down, pose.ahead),
                (pose.ahead, pose.right),
            ] {
                assert!(dot(a, b).abs() < 1e-12 && (length(a) - 1.0).abs() < 1e-12);
            }
            assert!(dot(cross(pose.right, pose.down), pose.ahead) > 0.999_999);
        }
    }

    #[test]
    fn the_matrix_undoes_camera_coordinates() {
        let pose = CameraPose::looking([1.0, -2.0, 3.0], [4.0, 0.0, 2.0], -0.4);
        let point = [0.3, 7.0, -1.2];
        let [x, y, z] = pose.to_camera(point);
        let back = pose
            .world_from_camera()
            .map(|row| row[0] * x + row[1] * y + row[2] * z + row[3]);
        assert!((0..3).all(|i| (back[i] - point[i]).abs() < 1e-12) && back[3] == 1.0);
    }
}
