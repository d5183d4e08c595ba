//! A straight circular cylinder with flat ends.

use imaging::vector::{Vec3, vec3};

use super::shape::ShapeGeometry;
use crate::site::bounds::Bounds;
use crate::site::lanes::{larger, smaller};

/// A cylinder about the z axis from 0 to `length`, in meters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tube {
    pub(crate) radius: f32,
    pub(crate) length: f32,
}

impl ShapeGeometry for Tube {
    #[inline(always)]
    fn enter(&self, o: Vec3, d: Vec3) -> f32 {
        let square = d.x * d.x + d.y * d.y;
        let along = d.x * o.x + d.y * o.y;
        // The cross product keeps the discriminant accurate for a thin cylinder far away.
        let aside = d.x * o.y - d.y * o.x;
        let discriminant = self.radius * self.radius * square - aside * aside;
        let side = (-along - larger(discriminant, 0.0).sqrt()) / square;
        let height = o.z + side * d.z;
        let on_side = (discriminant > 0.0) & (side > 0.0) & (height >= 0.0) & (height <= self.length);
        let end = if d.z > 0.0 { 0.0 } else { self.length };
        let cap = (end - o.z) / d.z;
        let (x, y) = (o.x + cap * d.x, o.y + cap * d.y);
        let on_cap = (cap > 0.0) & (x * x + y * y <= self.radius * self.radius);
        let cap = if on_cap { cap } else { f32::INFINITY };
        if on_side { side } else { cap }
    }

    #[inline(always)]
    fn distance(&self, p: Vec3) -> f32 {
        let beside = (p.x * p.x + p.y * p.y).sqrt() - self.radius;
        let half = 0.5 * self.length;
        let beyond = (p.z - half).abs() - half;
        let (a, b) = (larger(beside, 0.0), larger(beyond, 0.0));
        smaller(larger(beside, beyond), 0.0) + (a * a + b * b).sqrt()
    }

    #[inline(always)]
    fn normal(&self, p: Vec3, bevel: f32) -> (Vec3, f32) {
        let around = larger((p.x * p.x + p.y * p.y).sqrt(), 1e-6);
        let half = 0.5 * self.length;
        let bevel = smaller(bevel, 0.4 * smaller(self.radius, half));
        let side = larger(around - self.radius + bevel, 0.0);
        let end = larger((p.z - half).abs() - half + bevel, 0.0);
        let scale = 1.0 / larger((side * side + end * end).sqrt(), 1e-9);
        let (side, end) = (side * scale, end * scale);
        let axial = if p.z > half { end } else { -end };
        let edge = 3.0 * (1.0 - larger(side, end));
        (
            vec3(p.x / around * side, p.y / around * side, axial),
            smaller(edge, 1.0),
        )
    }

    fn bounds(&self) -> Bounds {
        Bounds::along_z(self.radius, self.length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TUBE: Tube = Tube {
        radius: 0.5,
        length: 2.0,
    };

    #[test]
    fn a_ray_across_the_axis_enters_one_radius_before_it() {
        let enter = TUBE.enter(vec3(-3.0, 0.0, 1.0), vec3(1.0, 0.0, 0.0));
        assert_eq!(enter, 2.5);
        // Off axis by 0.3 the half chord is 0.4.
        let enter = TUBE.enter(vec3(-3.0, 0.3, 1.0), vec3(2.0, 0.0, 0.0));
        assert!((enter - 1.3).abs() < 1e-6);
    }

    #[test]
    fn ends_are_closed_and_finite() {
        assert_eq!(TUBE.enter(vec3(0.2, 0.0, 5.0), vec3(0.0, 0.0, -1.0)), 3.0);
        assert_eq!(TUBE.enter(vec3(0.2, 0.0, -5.0), vec3(0.0, 0.0, 1.0)), 5.0);
        assert_eq!(
            TUBE.enter(vec3(-3.0, 0.0, 2.1), vec3(1.0, 0.0, 0.0)),
            f32::INFINITY
        );
        assert_eq!(
            TUBE.enter(vec3(3.0, 0.0, 1.0), vec3(1.0, 0.0, 0.0)),
            f32::INFINITY
        );
    }

    #[test]
    fn distance_is_measured_to_side_end_and_rim() {
        assert!((TUBE.distance(vec3(1.5, 0.0, 1.0)) - 1.0).abs() < 1e-6);
        assert!((TUBE.distance(vec3(0.0, 0.0, 2.7)) - 0.7).abs() < 1e-6);
        assert!((TUBE.distance(vec3(0.8, 0.0, 2.4)) - 0.5).abs() < 1e-6);
    }
}
