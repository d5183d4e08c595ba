//! A box.

use imaging::vector::{Vec3, vec3};

use super::Form;
use crate::site::bounds::Bounds;
use crate::site::lanes::{larger, smaller};

/// A box about the origin, half sides in meters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Block {
    pub(crate) half: Vec3,
}

/// The reciprocal, finite at 0.
#[inline(always)]
fn inverse(d: f32) -> f32 {
    1.0 / if d.abs() < 1e-12 { 1e-12 } else { d }
}

impl Form for Block {
    #[inline(always)]
    fn enter(&self, o: Vec3, d: Vec3) -> f32 {
        let slab = |o: f32, d: f32, half: f32| {
            let inverse = inverse(d);
            let (middle, reach) = (-o * inverse, half * inverse.abs());
            (middle - reach, middle + reach)
        };
        let (x, y, z) = (
            slab(o.x, d.x, self.half.x),
            slab(o.y, d.y, self.half.y),
            slab(o.z, d.z, self.half.z),
        );
        let enter = larger(larger(x.0, y.0), z.0);
        let leave = smaller(smaller(x.1, y.1), z.1);
        if (enter < leave) & (enter > 0.0) {
            enter
        } else {
            f32::INFINITY
        }
    }

    #[inline(always)]
    fn distance(&self, p: Vec3) -> f32 {
        let (x, y, z) = (
            p.x.abs() - self.half.x,
            p.y.abs() - self.half.y,
            p.z.abs() - self.half.z,
        );
        let (a, b, c) = (larger(x, 0.0), larger(y, 0.0), larger(z, 0.0));
        smaller(larger(larger(x, y), z), 0.0) + (a * a + b * b + c * c).sqrt()
    }

    #[inline(always)]
    fn normal(&self, p: Vec3, bevel: f32) -> (Vec3, f32) {
        let bevel = smaller(
            bevel,
            0.4 * smaller(smaller(self.half.x, self.half.y), self.half.z),
        );
        let part = |p: f32, half: f32| larger(p.abs() - half + bevel, 0.0);
        let (x, y, z) = (
            part(p.x, self.half.x),
            part(p.y, self.half.y),
            part(p.z, self.half.z),
        );
        let scale = 1.0 / larger((x * x + y * y + z * z).sqrt(), 1e-9);
        let edge = 3.0 * (1.0 - scale * larger(larger(x, y), z));
        let signed = |part: f32, p: f32| if p < 0.0 { -part * scale } else { part * scale };
        (
            vec3(signed(x, p.x), signed(y, p.y), signed(z, p.z)),
            smaller(edge, 1.0),
        )
    }

    fn bounds(&self) -> Bounds {
        Bounds::about_origin(self.half)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLOCK: Block = Block {
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
