//! The four walls around a rectangular shaft, seen from inside.

use imaging::vector::{Vec3, vec3};

use super::shape::ShapeGeometry;
use crate::site::bounds::Bounds;
use crate::site::lanes::{larger, smaller};

/// The walls of a box about the origin, half sides in meters; it is open at its ends in z.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Room {
    pub(crate) half: Vec3,
}

impl ShapeGeometry for Room {
    /// First hit of a ray from inside.
    #[inline(always)]
    fn enter(&self, o: Vec3, d: Vec3) -> f32 {
        let parameter = smaller(leave(o.x, d.x, self.half.x), leave(o.y, d.y, self.half.y));
        let height = o.z + parameter * d.z;
        if (parameter > 0.0) & (height.abs() <= self.half.z) {
            parameter
        } else {
            f32::INFINITY
        }
    }

    #[inline(always)]
    fn distance(&self, p: Vec3) -> f32 {
        smaller(self.half.x - p.x.abs(), self.half.y - p.y.abs())
    }

    #[inline(always)]
    fn normal(&self, p: Vec3, _: f32) -> (Vec3, f32) {
        let (x, y) = (self.half.x - p.x.abs(), self.half.y - p.y.abs());
        let normal = if x < y {
            vec3(inward(p.x), 0.0, 0.0)
        } else {
            vec3(0.0, inward(p.y), 0.0)
        };
        (normal, larger(1.0 - larger(x, y) * 20.0, 0.0))
    }

    fn bounds(&self) -> Bounds {
        Bounds::about_origin(self.half)
    }
}

/// Parameter where a ray from inside leaves the slab of this half width.
#[inline(always)]
fn leave(o: f32, d: f32, half: f32) -> f32 {
    let inverse = 1.0 / if d.abs() < 1e-12 { 1e-12 } else { d };
    half * inverse.abs() - o * inverse
}

#[inline(always)]
fn inward(p: f32) -> f32 {
    if p < 0.0 { 1.0 } else { -1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_from_inside_reaches_the_wall_that_is_nearest_along_it() {
        let room = Room {
            half: vec3(2.0, 3.0, 5.0),
        };
        let eye = vec3(1.0, 0.0, 0.0);
        assert_eq!(room.enter(eye, vec3(1.0, 0.0, 0.0)), 1.0);
        assert_eq!(room.enter(eye, vec3(1.0, 4.0, 0.0)), 0.75);
        assert_eq!(room.enter(eye, vec3(0.0, 0.0, 1.0)), f32::INFINITY);
        assert_eq!(room.normal(vec3(0.5, 3.0, 0.0), 0.0), (vec3(0.0, -1.0, 0.0), 0.0));
        assert_eq!(room.distance(eye), 1.0);
    }
}
