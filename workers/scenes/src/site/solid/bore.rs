//! The wall around a straight circular bore: a tunnel or a shaft, seen from inside.

use imaging::vector::{Vec3, vec3};

use super::shape::ShapeGeometry;
use crate::site::bounds::Bounds;
use crate::site::lanes::{larger, smaller};

/// The wall of a bore about the z axis from 0 to `length`, in meters. Its ends are open.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bore {
    pub(crate) radius: f32,
    pub(crate) length: f32,
}

impl ShapeGeometry for Bore {
    /// First hit of a ray from inside.
    #[inline(always)]
    fn enter(&self, o: Vec3, d: Vec3) -> f32 {
        let square = larger(d.x * d.x + d.y * d.y, 1e-12);
        let along = d.x * o.x + d.y * o.y;
        let aside = d.x * o.y - d.y * o.x;
        let discriminant = self.radius * self.radius * square - aside * aside;
        let parameter = (larger(discriminant, 0.0).sqrt() - along) / square;
        let height = o.z + parameter * d.z;
        if (discriminant > 0.0) & (parameter > 0.0) & (height >= 0.0) & (height <= self.length) {
            parameter
        } else {
            f32::INFINITY
        }
    }

    #[inline(always)]
    fn distance(&self, p: Vec3) -> f32 {
        self.radius - (p.x * p.x + p.y * p.y).sqrt()
    }

    #[inline(always)]
    fn normal(&self, p: Vec3, _: f32) -> (Vec3, f32) {
        let inward = -1.0 / larger((p.x * p.x + p.y * p.y).sqrt(), 1e-6);
        let from_end = smaller(p.z, self.length - p.z);
        let edge = larger(1.0 - from_end * 20.0, 0.0);
        (vec3(p.x * inward, p.y * inward, 0.0), edge)
    }

    fn bounds(&self) -> Bounds {
        Bounds::along_z(self.radius, self.length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_from_inside_reaches_the_far_wall_and_leaves_through_an_end() {
        let bore = Bore {
            radius: 2.0,
            length: 10.0,
        };
        let eye = vec3(-1.0, 0.0, 5.0);
        assert_eq!(bore.enter(eye, vec3(1.0, 0.0, 0.0)), 3.0);
        assert_eq!(bore.enter(eye, vec3(-1.0, 0.0, 0.0)), 1.0);
        assert_eq!(bore.enter(eye, vec3(0.0, 0.0, 1.0)), f32::INFINITY);
        assert_eq!(bore.normal(vec3(2.0, 0.0, 5.0), 0.0).0, vec3(-1.0, 0.0, 0.0));
        assert_eq!(bore.distance(eye), 1.0);
    }
}
