//! Ellipsoid.

use imaging::vector::Vec3;

use super::shape::{ShapeGeometry, beyond_box};
use crate::site::bounds::Bounds;
use crate::site::lanes::{larger, smallest};

/// An ellipsoid about the origin, radii in meters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ellipsoid {
    pub(crate) radii: Vec3,
}

impl Ellipsoid {
    #[inline(always)]
    fn scaled(&self, v: Vec3) -> Vec3 {
        v.zip(self.radii, |v, radius| v / radius)
    }
}

impl ShapeGeometry for Ellipsoid {
    #[inline(always)]
    fn enter(&self, o: Vec3, d: Vec3) -> f32 {
        let (o, d) = (self.scaled(o), self.scaled(d));
        let square = d.dot(d);
        let cross = o.cross(d);
        let discriminant = square - cross.dot(cross);
        let enter = (-o.dot(d) - larger(discriminant, 0.0).sqrt()) / square;
        if (discriminant > 0.0) & (enter > 0.0) {
            enter
        } else {
            f32::INFINITY
        }
    }

    #[inline(always)]
    fn distance(&self, p: Vec3) -> f32 {
        let near = (self.scaled(p).length() - 1.0) * smallest(self.radii);
        larger(near, beyond_box(p, self.radii))
    }

    #[inline(always)]
    fn normal(&self, p: Vec3, _: f32) -> (Vec3, f32) {
        let outward = self.scaled(self.scaled(p));
        (outward * (1.0 / larger(outward.length(), 1e-9)), 0.0)
    }

    fn bounds(&self) -> Bounds {
        Bounds::about_origin(self.radii)
    }
}

#[cfg(test)]
mod tests {
    use imaging::vector::vec3;

    use super::*;

    #[test]
    fn a_ray_enters_an_ellipsoid_at_its_radius() {
        let ball = Ellipsoid {
            radii: vec3(1.0, 2.0, 0.5),
        };
        assert_eq!(ball.enter(vec3(0.0, -5.0, 0.0), vec3(0.0, 1.0, 0.0)), 3.0);
        assert_eq!(
            ball.enter(vec3(1.01, -5.0, 0.0), vec3(0.0, 1.0, 0.0)),
            f32::INFINITY
        );
        assert_eq!(ball.normal(vec3(0.0, 0.0, 0.5), 0.0).0, vec3(0.0, 0.0, 1.0));
    }
}
