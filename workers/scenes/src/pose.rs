//! Position and orientation of a camera in the world.

use imaging::vector::{DVec3, vec3};
use serde_json::Value;
use spec::{FieldError, Invalid};

/// Allowed deviation of an uploaded pose from orthonormal axes: files round to three decimals at worst.
pub const ORTHONORMAL_TOLERANCE: f64 = 2e-3;
/// Largest coordinate of an uploaded camera, m: the size of the Earth, for geodetic frames.
pub const MAX_POSITION_M: f64 = 1e7;

/// Position and axes of a camera in the world: meters, z up, the ground at z = 0.
///
/// The axes are those of the picture: x right, y down, z ahead; orthonormal and right-handed. A point `p` of the world
/// has the camera coordinates `(right·(p-c), down·(p-c), ahead·(p-c))` with the position c (Hartley and Zisserman 2004,
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
    /// A camera at `eye` that looks at `target`, level except for `roll` radians about its optical axis (positive: the
    /// picture of the world turns clockwise). For a vertical line of sight, the world's x axis points right. `target`
    /// must differ from `eye`.
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

    /// The pose of a row-major matrix from camera to world coordinates. Axes within [`ORTHONORMAL_TOLERANCE`] of an
    /// orthonormal right-handed system are orthonormalized: the optical axis keeps its direction, then the picture's
    /// rows.
    ///
    /// # Errors
    /// The violated condition.
    pub fn from_matrix(matrix: &[[f64; 4]; 4]) -> Result<Self, &'static str> {
        let [right, down, ahead, position_m] =
            [0, 1, 2, 3].map(|column: usize| DVec3::from([0, 1, 2].map(|row: usize| matrix[row][column])));
        if matrix.as_flattened().iter().any(|value| !value.is_finite()) {
            return Err("all numbers must be finite");
        }
        if matrix[3] != [0.0, 0.0, 0.0, 1.0] {
            return Err("the last row must be [0, 0, 0, 1]");
        }
        if [position_m.x, position_m.y, position_m.z]
            .into_iter()
            .any(|place| place.abs() > MAX_POSITION_M)
        {
            return Err("the camera must be within 1e7 m of the origin");
        }
        let products = [right.dot(down), down.dot(ahead), ahead.dot(right)];
        let lengths = [right, down, ahead].map(|axis| axis.dot(axis) - 1.0);
        if products
            .into_iter()
            .chain(lengths)
            .any(|off| off.abs() > ORTHONORMAL_TOLERANCE)
        {
            return Err("the first three columns must have length 1 and be perpendicular");
        }
        if right.cross(down).dot(ahead) < 0.0 {
            return Err("the axes right, down, ahead must be right-handed");
        }
        let ahead = ahead.normalized();
        let right = (right - ahead * right.dot(ahead)).normalized();
        Ok(Self {
            position_m,
            right,
            down: ahead.cross(right),
            ahead,
        })
    }

    /// The row-major 4×4 matrix from camera to world coordinates.
    #[must_use]
    pub fn world_from_camera(&self) -> [[f64; 4]; 4] {
        let columns = [self.right, self.down, self.ahead, self.position_m];
        let [x, y, z] = [columns.map(|v| v.x), columns.map(|v| v.y), columns.map(|v| v.z)];
        [x, y, z, [0.0, 0.0, 0.0, 1.0]]
    }

    /// The pose this many meters to the right, with the same axes.
    #[must_use]
    pub fn moved_right(self, meters: f64) -> Self {
        Self {
            position_m: self.position_m + self.right * meters,
            ..self
        }
    }

    /// Camera coordinates of a world point in meters: right, down, ahead.
    #[must_use]
    pub fn to_camera(&self, point: DVec3) -> DVec3 {
        let away = point - self.position_m;
        [self.right, self.down, self.ahead]
            .map(|axis| axis.dot(away))
            .into()
    }
}

/// Reads the pose of an uploaded scene: `{"world_from_camera": [[…], …]}` with a row-major matrix, or the matrix alone.
///
/// # Errors
/// The violated condition with its JSON pointer.
pub fn read(text: &[u8]) -> Result<[[f64; 4]; 4], Invalid> {
    let shape =
        "a pose must be {\"world_from_camera\": [[…], […], […], [0, 0, 0, 1]]}, four rows of four numbers";
    let mut value = spec::read_json(text)?;
    if let Value::Object(map) = &mut value {
        value = match (map.len(), map.remove("world_from_camera")) {
            (1, Some(matrix)) => matrix,
            _ => return Err(rejection(shape)),
        };
    }
    let matrix: [[f64; 4]; 4] = serde_json::from_value(value).map_err(|_| rejection(shape))?;
    CameraPose::from_matrix(&matrix).map_err(rejection)?;
    Ok(matrix)
}

fn rejection(message: &str) -> Invalid {
    Invalid(vec![FieldError::new("", message)])
}

/// Minimum distance from surfaces of a camera on a path, m.
pub const LEAST_CLEARANCE_M: f64 = 0.05;

#[cfg(test)]
mod tests {
    use super::*;

    const LEVEL: &str = "[[1, 0, 0, 7], [0, 0, 1, 8], [0, -1, 0, 9], [0, 0, 0, 1]]";

    #[test]
    fn a_pose_is_a_matrix_with_or_without_its_name() {
        let named = format!("{{\"world_from_camera\": {LEVEL}}}");
        let matrix = read(LEVEL.as_bytes()).unwrap();
        assert_eq!(read(named.as_bytes()).unwrap(), matrix);
        assert_eq!(
            CameraPose::from_matrix(&matrix).unwrap().world_from_camera(),
            matrix
        );
    }

    #[test]
    fn a_pose_that_is_none_is_refused_with_the_reason() {
        let wrong = |text: &str| read(text.as_bytes()).unwrap_err().to_string();
        for (change, reason) in [
            (("[1, 0, 0, 7]", "[-1, 0, 0, 7]"), "right-handed"),
            (("[1, 0, 0, 7]", "[2, 0, 0, 7]"), "length 1"),
            (("[1, 0, 0, 7]", "[1, 0, 0.1, 7]"), "perpendicular"),
            (("[1, 0, 0, 7]", "[1, 0, 0, 1e8]"), "1e7 m"),
            (("[0, 0, 0, 1]", "[0, 0, 0, 2]"), "last row"),
            (("[0, 0, 0, 1]", "[0, 0, 1]"), "four rows of four numbers"),
        ] {
            let message = wrong(&LEVEL.replace(change.0, change.1));
            assert!(message.contains(reason), "{message}");
        }
        for text in ["{}", "{\"pose\": []}", "7", "null", "[[\"a\"]]"] {
            assert!(wrong(text).contains("world_from_camera"), "{text}");
        }
    }

    #[test]
    fn a_rounded_pose_becomes_orthonormal() {
        let mut matrix =
            CameraPose::looking(vec3(1.0, -2.0, 3.0), vec3(4.0, 0.0, 2.0), -0.4).world_from_camera();
        for value in matrix.as_flattened_mut() {
            *value = (*value * 1e3).round() / 1e3;
        }
        let pose = CameraPose::from_matrix(&matrix).unwrap();
        for (a, b) in [
            (pose.right, pose.down),
            (pose.down, pose.ahead),
            (pose.ahead, pose.right),
        ] {
            assert!(a.dot(b).abs() < 1e-12 && (a.length() - 1.0).abs() < 1e-12);
        }
    }

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
