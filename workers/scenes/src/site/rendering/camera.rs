//! The pinhole camera in single precision: the ray of a pixel, and the projection of a point.

use imaging::geometry::Intrinsics;
use imaging::vector::{Vec3, vec3};

use crate::CameraPose;

/// A camera in the scene. EyeRays are not normalized: a ray parameter is a z-depth, and `parameter * |ray|` a range.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ViewCamera {
    pub(crate) eye: Vec3,
    pub(crate) ahead: Vec3,
    pub(crate) right: Vec3,
    pub(crate) down: Vec3,
    /// Also the angle of a pixel at the principal point, radians.
    pub(crate) inverse_focal: f32,
    cx: f32,
    cy: f32,
    pub(crate) width: usize,
    pub(crate) height: usize,
}

impl ViewCamera {
    pub(crate) fn new(pose: &CameraPose, (width, height): (usize, usize), lens: &Intrinsics) -> Self {
        Self {
            eye: pose.position_m.as_f32(),
            ahead: pose.ahead.as_f32(),
            right: pose.right.as_f32(),
            down: pose.down.as_f32(),
            inverse_focal: (1.0 / lens.focal_px) as f32,
            cx: lens.cx as f32,
            cy: lens.cy as f32,
            width,
            height,
        }
    }

    /// The ray through (x, y) in index coordinates.
    #[inline(always)]
    pub(crate) fn ray(&self, x: f32, y: f32) -> Vec3 {
        self.ahead
            + self.right * ((x - self.cx) * self.inverse_focal)
            + self.down * ((y - self.cy) * self.inverse_focal)
    }

    /// Difference of the rays of horizontal neighbors.
    pub(crate) fn column_step(&self) -> Vec3 {
        self.right * self.inverse_focal
    }

    /// A point in camera axes: right, down, ahead, in meters.
    #[inline(always)]
    pub(crate) fn axes_of(&self, point: Vec3) -> Vec3 {
        let away = point - self.eye;
        vec3(away.dot(self.right), away.dot(self.down), away.dot(self.ahead))
    }

    /// Index coordinates of a point ahead, in camera axes.
    #[inline(always)]
    pub(crate) fn project(&self, point: Vec3) -> (f32, f32) {
        let scale = 1.0 / (self.inverse_focal * point.z);
        (self.cx + point.x * scale, self.cy + point.y * scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_on_the_ray_of_a_pixel_appears_in_that_pixel() {
        let lens = Intrinsics {
            focal_px: 50.0,
            cx: 30.0,
            cy: 12.0,
        };
        let camera = ViewCamera::new(
            &CameraPose::looking(vec3(1.0, 2.0, 3.0), vec3(4.0, 6.0, 2.0), 0.2),
            (64, 48),
            &lens,
        );
        let point = camera.eye + camera.ray(7.0, 40.0) * 2.5;
        let (x, y) = camera.project(camera.axes_of(point));
        assert!((x - 7.0).abs() < 1e-3 && (y - 40.0).abs() < 1e-3);
        assert!((camera.axes_of(point).z - 2.5).abs() < 1e-5);
    }

    #[test]
    fn a_level_camera_sees_up_at_the_top() {
        let lens = Intrinsics::centered(50.0, 3, 3);
        let camera = ViewCamera::new(
            &CameraPose::looking(vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 1.0), 0.0),
            (3, 3),
            &lens,
        );
        assert!(camera.ray(1.0, 0.0).z > 0.0);
        assert!(camera.ray(2.0, 1.0).y < 0.0);
    }
}
