//! The pinhole camera, and range along the ray from distance along the optical axis.

use serde::{Deserialize, Serialize};

use crate::plane::Plane;
use crate::vector::{DVec3, vec3};

/// A pinhole camera with square pixels, in index coordinates: the center of pixel (0, 0) is (0, 0).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Intrinsics {
    /// Focal length in pixels, above 0.
    pub focal_px: f64,
    /// Column of the principal point in pixels.
    pub cx: f64,
    /// Row of the principal point in pixels.
    pub cy: f64,
}

impl Intrinsics {
    /// A camera whose principal point is the center of the frame: `((W-1)/2, (H-1)/2)`.
    #[must_use]
    pub fn centered(focal_px: f64, width: usize, height: usize) -> Self {
        Self {
            focal_px,
            cx: (width as f64 - 1.0) / 2.0,
            cy: (height as f64 - 1.0) / 2.0,
        }
    }

    /// The ray of a picture position in camera axes (right, down, ahead): `((x-cx)/f, (y-cy)/f, 1)`, not normalized.
    #[must_use]
    pub fn ray(&self, x: f64, y: f64) -> DVec3 {
        vec3((x - self.cx) / self.focal_px, (y - self.cy) / self.focal_px, 1.0)
    }

    /// Length of the ray of a pixel up to z = 1, `sqrt(1 + ((x-cx)/f)² + ((y-cy)/f)²)`: the factor from z-depth to range.
    #[must_use]
    pub fn ray_length(&self, x: usize, y: usize) -> f64 {
        let u = (x as f64 - self.cx) / self.focal_px;
        let v = (y as f64 - self.cy) / self.focal_px;
        (1.0 + u * u + v * v).sqrt()
    }
}

/// Range in meters along the ray, `Z = d sqrt(1 + ((x-cx)/f)² + ((y-cy)/f)²)`, from z-depth `d` in meters. Invalid
/// distances (NaN, infinity, 0, negative) are unchanged.
#[must_use]
pub fn range_from_z_depth(z_depth: &Plane<f32>, camera: &Intrinsics) -> Plane<f32> {
    Plane::from_fn(z_depth.width(), z_depth.height(), |x, y| {
        (f64::from(z_depth.pixel(x, y)) * camera.ray_length(x, y)) as f32
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn range_grows_away_from_the_principal_point_of_a_flat_wall() {
        let wall = Plane::filled(3, 1, 2.0f32);
        let camera = Intrinsics {
            focal_px: 1.0,
            cx: 1.0,
            cy: 0.0,
        };
        let range = range_from_z_depth(&wall, &camera);
        assert_eq!(range.pixel(1, 0), 2.0);
        assert!((range.pixel(0, 0) - 2.0 * 2.0f32.sqrt()).abs() < 1e-6);
        assert_eq!(range.pixel(0, 0), range.pixel(2, 0));
    }
}
