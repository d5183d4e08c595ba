//! Pose of the camera in the world: particles and patches keep their places while the camera moves.

use imaging::geometry::Intrinsics;

/// A camera and its pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eye {
    /// Its lens.
    pub camera: Intrinsics,
    /// Rows of the matrix from camera axes (right, down, ahead, 1) to the world, meters; its first three columns are of length 1
    /// and at right angles.
    pub world_from_camera: [[f64; 4]; 4],
}

impl Eye {
    /// A camera whose axes are the world's.
    #[must_use]
    pub fn at_origin(camera: Intrinsics) -> Self {
        let row = |i: usize| [0, 1, 2, 3].map(|j| f64::from(u8::from(i == j)));
        Self {
            camera,
            world_from_camera: [row(0), row(1), row(2), row(3)],
        }
    }

    /// The world's coordinates of a point in camera axes.
    #[must_use]
    pub fn to_world(&self, point: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| {
            let [right, down, ahead, place] = self.world_from_camera[i];
            right * point[0] + down * point[1] + ahead * point[2] + place
        })
    }

    /// Camera axes of a point of the world.
    #[must_use]
    pub fn to_camera(&self, point: [f64; 3]) -> [f64; 3] {
        let away = [0, 1, 2].map(|i| point[i] - self.world_from_camera[i][3]);
        self.turned(away)
    }

    /// A direction of the world in camera axes.
    #[must_use]
    pub(crate) fn turned(&self, direction: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|j| (0..3).map(|i| self.world_from_camera[i][j] * direction[i]).sum())
    }

    /// Where the camera is.
    #[must_use]
    pub(crate) fn position(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| self.world_from_camera[i][3])
    }

    /// The unit vector along the ray of a point of the picture, in camera axes.
    #[must_use]
    pub(crate) fn ray(&self, column: f64, row: f64) -> [f64; 3] {
        let ray = self.camera.ray(column, row);
        let length = ray.length();
        [ray.x / length, ray.y / length, ray.z / length]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back_is_the_same_point() {
        let eye = Eye {
            camera: Intrinsics::centered(100.0, 9, 7),
            world_from_camera: [
                [0.0, -0.6, 0.8, 4.0],
                [1.0, 0.0, 0.0, -2.0],
                [0.0, 0.8, 0.6, 9.0],
                [0.0, 0.0, 0.0, 1.0],
            ],
        };
        let there = eye.to_camera(eye.to_world([1.0, 2.0, 3.0]));
        for (got, expected) in there.into_iter().zip([1.0, 2.0, 3.0]) {
            assert!((got - expected).abs() < 1e-12);
        }
        assert_eq!(eye.position(), [4.0, -2.0, 9.0]);
        assert_eq!(eye.ray(4.0, 3.0), [0.0, 0.0, 1.0]);
        let still = Eye::at_origin(eye.camera);
        assert_eq!(still.to_world([1.0, 2.0, 3.0]), [1.0, 2.0, 3.0]);
    }
}
