//! A broken stone: the intersection of a dozen half-spaces.

use imaging::vector::{Vec3, vec3};

use super::shape::{ShapeGeometry, beyond_box};
use crate::site::bounds::Bounds;
use crate::site::chance::Choices;
use crate::site::lanes::{larger, smaller};

const PLANES: usize = 14;

/// Inside of every plane: `normal · p <= offset`, in meters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stone {
    pub(super) planes: [(Vec3, f32); PLANES],
    reach: Vec3,
}

/// Unrolls a loop over the planes of a stone: the compiler vectorizes loops over rays and points only without inner
/// loops.
macro_rules! for_planes {
    ($stone:expr, $normal:ident, $offset:ident => $work:block) => {
        for_planes!($stone, $normal, $offset => $work; 0 1 2 3 4 5 6 7 8 9 10 11 12 13)
    };
    ($stone:expr, $normal:ident, $offset:ident => $work:block; $($number:literal)*) => {
        $({
            let ($normal, $offset) = $stone.planes[$number];
            $work
        })*
    };
}

impl Stone {
    /// A stone of about the given half sides.
    pub(crate) fn broken(half: Vec3, dice: Choices) -> Self {
        // The directions of a golden spiral are evenly spread, so that the body is closed on every side.
        let planes = std::array::from_fn(|i| {
            let choice = 100 + 4 * i as u64;
            let z = 1.0 - (2.0 * i as f32 + 1.0) / PLANES as f32 + dice.uniform(choice, -0.06, 0.06);
            let (sin, cos) = libm::sincosf(2.399_963 * i as f32 + dice.uniform(choice + 1, -0.35, 0.35));
            let flat = (1.0 - z * z).max(0.0).sqrt();
            let direction = vec3(flat * cos, flat * sin, z);
            // The plane that cuts the unit ball, stretched to the half sides.
            let normal = direction.zip(half, |v, half| v / half);
            let scale = 1.0 / normal.length();
            (normal * scale, scale * dice.uniform(choice + 2, 0.62, 0.95))
        });
        Self {
            planes,
            reach: half * 1.7,
        }
    }
}

impl ShapeGeometry for Stone {
    #[inline(always)]
    fn enter(&self, o: Vec3, d: Vec3) -> f32 {
        let (mut enter, mut leave) = (0.0, f32::INFINITY);
        for_planes!(self, normal, offset => {
            let (toward, above) = (normal.dot(d), normal.dot(o) - offset);
            let t = -above / toward;
            enter = if toward < 0.0 { larger(t, enter) } else { enter };
            leave = if toward > 0.0 { smaller(t, leave) } else { leave };
        });
        if (enter < leave) & (enter > 0.0) {
            enter
        } else {
            f32::INFINITY
        }
    }

    #[inline(always)]
    fn distance(&self, p: Vec3) -> f32 {
        let mut farthest = -1e9;
        for_planes!(self, normal, offset => {
            farthest = larger(farthest, normal.dot(p) - offset);
        });
        larger(farthest, beyond_box(p, self.reach))
    }

    #[inline(always)]
    fn normal(&self, p: Vec3, bevel: f32) -> (Vec3, f32) {
        let bevel = bevel * (1.0 + 5.0 * self.reach.z);
        let (mut sum, mut most) = (vec3(0.0, 0.0, 1e-12), 0.0);
        for_planes!(self, normal, offset => {
            let share = larger(normal.dot(p) - offset + bevel, 0.0);
            sum = sum + normal * (share * share);
            most = larger(most, share * share);
        });
        let length = sum.length();
        (
            sum * (1.0 / length),
            smaller(2.0 * (1.0 - most / larger(length, most)), 1.0),
        )
    }

    fn bounds(&self) -> Bounds {
        Bounds::about_origin(self.reach)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stone_is_closed_and_stays_in_its_box() {
        for seed in 0..20 {
            let stone = Stone::broken(vec3(1.0, 0.7, 0.5), Choices::new(seed, "structure.test"));
            let Bounds { low, high } = stone.bounds();
            for turn in 0..64 {
                let (sin, cos) = libm::sincosf(turn as f32 * 0.1);
                let eye = vec3(10.0 * cos, 10.0 * sin, 4.0);
                let enter = stone.enter(eye, -eye);
                let p = eye + -eye * enter;
                assert!(enter.is_finite() && stone.distance(p).abs() < 1e-4);
                assert!(p.x > low.x && p.x < high.x && p.y > low.y && p.y < high.y && p.z < high.z);
            }
        }
    }
}
