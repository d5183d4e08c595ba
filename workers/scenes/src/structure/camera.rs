//! The pinhole camera of a scene: which way the ray of a pixel leaves, and where a point of the scene appears.

use imaging::geometry::Intrinsics;

use super::vector::{UP, Vec3, vec3};

/// A camera in the scene. Rays are not normalised: a ray advances one metre along the optical axis for each
/// unit of its parameter, so a parameter is a z-depth, and `parameter * |ray|` a range.
#[derive(Debug, Clone, Copy)]
pub(super) struct Camera {
    pub eye: Vec3,
    pub ahead: Vec3,
    pub right: Vec3,
    pub down: Vec3,
    focal_px: f32,
    cx: f32,
    cy: f32,
    pub width: usize,
    pub height: usize,
}

impl Camera {
    /// A camera at `eye` that looks at `target`, turned by `roll` radians about its optical axis.
    pub(super) fn looking(
        eye: Vec3,
        target: Vec3,
        roll: f32,
        (width, height): (usize, usize),
        lens: &Intrinsics,
    ) -> Self {
        let ahead = (target - eye).unit();
        let level = if ahead.z.abs() < 0.999 {
            ahead.cross(UP).unit()
        } else {
            vec3(1.0, 0.0, 0.0)
        };
        let (sin, cos) = libm::sincosf(roll);
        let right = level * cos + ahead.cross(level) * sin;
        let down = ahead.cross(right);
        let (focal_px, cx, cy) = (lens.focal_px as f32, lens.cx as f32, lens.cy as f32);
        Self {
            eye,
            ahead,
            right,
            down,
            focal_px,
            cx,
            cy,
            width,
            height,
        }
    }

    /// The ray through (x, y) in index coordinates.
    #[inline(always)]
    pub(super) fn ray(&self, x: f32, y: f32) -> Vec3 {
        self.ahead
            + self.right * ((x - self.cx) / self.focal_px)
            + self.down * ((y - self.cy) / self.focal_px)
    }

    /// What one pixel to the right adds to a ray.
    pub(super) fn across(&self) -> Vec3 {
        self.right * (1.0 / self.focal_px)
    }

    /// The angle that a pixel spans at the principal point, in radians.
    pub(super) fn pixel_angle(&self) -> f32 {
        1.0 / self.focal_px
    }

    /// A point in camera axes: right, down, ahead, in metres.
    #[inline(always)]
    pub(super) fn axes_of(&self, point: Vec3) -> Vec3 {
        let away = point - self.eye;
        vec3(away.dot(self.right), away.dot(self.down), away.dot(self.ahead))
    }

    /// Index coordinates of a point in camera axes that lies ahead.
    #[inline(always)]
    pub(super) fn project(&self, point: Vec3) -> (f32, f32) {
        let scale = self.focal_px / point.z;
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
        let camera = Camera::looking(vec3(1.0, 2.0, 3.0), vec3(4.0, 6.0, 2.0), 0.2, (64, 48), &lens);
        let point = camera.eye + camera.ray(7.0, 40.0) * 2.5;
        let (x, y) = camera.project(camera.axes_of(point));
        assert!((x - 7.0).abs() < 1e-3 && (y - 40.0).abs() < 1e-3);
        assert!((camera.axes_of(point).z - 2.5).abs() < 1e-5);
    }

    #[test]
    fn a_level_camera_sees_up_at_the_top() {
        let lens = Intrinsics::centred(50.0, 3, 3);
        let camera = Camera::looking(vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 1.0), 0.0, (3, 3), &lens);
        assert!(camera.ray(1.0, 0.0).z > 0.0);
        assert!(camera.ray(2.0, 1.0).y < 0.0);
    }
}
