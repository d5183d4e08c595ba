//! Box.

use imaging::vector::Vec3;

use super::shape::ShapeGeometry;
use crate::site::bounds::Bounds;
use crate::site::lanes::{larger, largest, smaller, smallest};

/// A box about the origin, half sides in meters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SolidBox {
    pub(crate) half: Vec3,
}

/// The reciprocal, finite at 0.
#[inline(always)]
fn inverse(d: f32) -> f32 {
    1.0 / if d.abs() < 1e-12 { 1e-12 } else { d }
}

impl ShapeGeometry for SolidBox {
    #[inline(always)]
    fn enter(&self, o: Vec3, d: Vec3) -> f32 {
        let inverse = d.map(inverse);
        let middle = o.zip(inverse, |o, inverse| -o * inverse);
        let reach = self.half.zip(inverse, |half, inverse| half * inverse.abs());
        let (enter, leave) = (largest(middle - reach), smallest(middle + reach));
        if (enter < leave) & (enter > 0.0) {
            enter
        } else {
            f32::INFINITY
        }
    }

    #[inline(always)]
    fn distance(&self, p: Vec3) -> f32 {
        let away = p.zip(self.half, |p, half| p.abs() - half);
        smaller(largest(away), 0.0) + away.map(|v| larger(v, 0.0)).length()
    }

    #[inline(always)]
    fn normal(&self, p: Vec3, bevel: f32) -> (Vec3, f32) {
        let bevel = smaller(bevel, 0.4 * smallest(self.half));
        let part = p.zip(self.half, |p, half| larger(p.abs() - half + bevel, 0.0));
        let scale = 1.0 / larger(part.length(), 1e-9);
        let edge = 3.0 * (1.0 - scale * largest(part));
        let normal = part.zip(p, |part, p| if p < 0.0 { -part * scale } else { part * scale });
        (normal, smaller(edge, 1.0))
    }

    fn bounds(&self) -> Bounds {
        Bounds::about_origin(self.half)
    }
}

#[cfg(test)]
mod tests {
    use imaging::vector::vec3;

    use super::*;

    const BLOCK: SolidBox = SolidBox {
        half: vec3(1.0, 2.0, 3.0),
    };

    #[test]
    fn a_ray_enters_at_the_face_it_meets_last() {
        assert_eq!(BLOCK.enter(vec3(-5.0, 0.0, 0.0), vec3(1.0, 0.0, 0.0)), 4.0);
        // Crosses x = -1 at 1 (y = 3, outside) and y = 2 at 2 (x = 0, inside).
        assert_eq!(BLOCK.enter(vec3(-2.0, 4.0, 0.0), vec3(1.0, -1.0, 0.0)), 2.0);
        assert_eq!(
            BLOCK.enter(vec3(-5.0, 2.5, 0.0), vec3(1.0, 0.0, 0.0)),
            f32::INFINITY
        );
        assert_eq!(
            BLOCK.enter(vec3(5.0, 0.0, 0.0), vec3(1.0, 0.0, 0.0)),
            f32::INFINITY
        );
    }

    #[test]
    fn normals_are_faces_and_turn_over_the_bevel() {
        let (face, edge) = BLOCK.normal(vec3(1.0, 0.0, 0.0), 0.1);
        assert_eq!((face, edge), (vec3(1.0, 0.0, 0.0), 0.0));
        let (corner, edge) = BLOCK.normal(vec3(1.0, 2.0, 0.0), 0.1);
        assert!((corner - vec3(0.5f32.sqrt(), 0.5f32.sqrt(), 0.0)).length() < 1e-6 && edge > 0.5);
    }
}
