//! Torus segment: a bend of a pipe.

use imaging::vector::{Vec3, vec3};

use super::shape::ShapeGeometry;
use crate::site::bounds::Bounds;
use crate::site::lanes::{larger, smaller};

/// The part of a torus about the z axis within `half_angle` of the +y direction, with rounded ends; meters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ring {
    pub(super) bend_radius: f32,
    pub(super) tube_radius: f32,
    pub(super) half_angle: [f32; 2],
}

/// Steps of the march; rays that graze the surface for longer count as misses.
const STEPS: usize = 28;
/// Largest distance from the surface of a hit, m.
const CONTACT_M: f32 = 2e-4;
/// A march stops at this distance from the surface, m.
const TOUCH_M: f32 = 2e-5;
/// EyeRays that march together.
pub(super) const WIDE: usize = 8;

impl Ring {
    /// A bend through twice `half_angle` (radians; pi closes the ring).
    pub(crate) fn new(bend_radius: f32, tube_radius: f32, half_angle: f32) -> Self {
        let (sin, cos) = libm::sincosf(half_angle);
        Self {
            bend_radius,
            tube_radius,
            half_angle: [sin, cos],
        }
    }

    /// Whether a ray enters the surface at a point of contact, as opposed to leaving it.
    #[inline(always)]
    pub(super) fn is_entered(&self, p: Vec3, d: Vec3) -> bool {
        (p - self.center_line(p)).dot(d) < 0.0
    }

    /// The nearest point of the center line.
    #[inline(always)]
    fn center_line(&self, p: Vec3) -> Vec3 {
        let [sin, cos] = self.half_angle;
        // On the axis every point of the ring is nearest: choose the middle of the bend.
        let p = if p.x.abs() + p.y.abs() < 1e-6 {
            vec3(p.x, 1e-6, p.z)
        } else {
            p
        };
        let x = p.x.abs();
        let beyond_end = cos * x > sin * p.y;
        let scale = self.bend_radius / larger((x * x + p.y * p.y).sqrt(), 1e-6);
        let (x, y) = if beyond_end {
            (sin * self.bend_radius, cos * self.bend_radius)
        } else {
            (x * scale, p.y * scale)
        };
        vec3(if p.x < 0.0 { -x } else { x }, y, 0.0)
    }

    /// Entry parameters of eight rays that march together until each touches the surface or has passed the ring.
    #[inline(always)]
    pub(super) fn enter_abreast(&self, o: [Vec3; WIDE], d: [Vec3; WIDE]) -> [f32; WIDE] {
        let reach = 1.05 * (self.bend_radius + self.tube_radius);
        let (mut at, mut end, mut pace, mut away) = ([0.0; WIDE], [0.0; WIDE], [0.0; WIDE], [0.0; WIDE]);
        for i in 0..WIDE {
            pace[i] = 1.0 / d[i].length();
            let closest = -o[i].dot(d[i]) * pace[i] * pace[i];
            at[i] = larger(closest - reach * pace[i], 0.0);
            end[i] = closest + reach * pace[i];
        }
        for _ in 0..STEPS {
            let mut moving = 0u32;
            for i in 0..WIDE {
                let found = self.distance(o[i] + d[i] * at[i]);
                let on = (found.abs() >= TOUCH_M) & (at[i] <= end[i]);
                at[i] += if on { found * pace[i] } else { 0.0 };
                away[i] = found;
                moving |= u32::from(on);
            }
            if moving == 0 {
                break;
            }
        }
        for i in 0..WIDE {
            let met = (away[i].abs() < CONTACT_M) & (at[i] > 0.0);
            at[i] = if met { at[i] } else { f32::INFINITY };
        }
        at
    }
}

impl ShapeGeometry for Ring {
    #[inline(always)]
    fn enter(&self, o: Vec3, d: Vec3) -> f32 {
        self.enter_abreast([o; WIDE], [d; WIDE])[0]
    }

    #[inline(always)]
    fn distance(&self, p: Vec3) -> f32 {
        (p - self.center_line(p)).length() - self.tube_radius
    }

    #[inline(always)]
    fn normal(&self, p: Vec3, _: f32) -> (Vec3, f32) {
        let outward = p - self.center_line(p);
        (outward * (1.0 / larger(outward.length(), 1e-9)), 0.0)
    }

    fn bounds(&self) -> Bounds {
        let (reach, tube) = (self.bend_radius + self.tube_radius, self.tube_radius);
        let [sin, cos] = self.half_angle;
        let x = if cos > 0.0 {
            smaller(reach, reach * sin + tube)
        } else {
            reach
        };
        let y = if cos > 0.0 {
            self.bend_radius * cos - 2.0 * tube
        } else {
            -reach
        };
        Bounds {
            low: vec3(-x, y, -tube),
            high: vec3(x, reach, tube),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_through_the_hole_passes_and_one_through_the_tube_enters() {
        let ring = Ring::new(1.0, 0.2, std::f32::consts::PI);
        assert_eq!(
            ring.enter(vec3(0.0, 0.0, 3.0), vec3(0.0, 0.0, -1.0)),
            f32::INFINITY
        );
        assert!((ring.enter(vec3(1.0, 0.0, 3.0), vec3(0.0, 0.0, -1.0)) - 2.8).abs() < 1e-4);
        assert!((ring.enter(vec3(-4.0, 0.0, 0.0), vec3(1.0, 0.0, 0.0)) - 2.8).abs() < 1e-4);
    }

    #[test]
    fn a_quarter_bend_has_only_its_quarter() {
        let bend = Ring::new(1.0, 0.2, std::f32::consts::FRAC_PI_4);
        assert!((bend.enter(vec3(0.0, 1.0, 3.0), vec3(0.0, 0.0, -1.0)) - 2.8).abs() < 1e-4);
        assert_eq!(
            bend.enter(vec3(0.0, -1.0, 3.0), vec3(0.0, 0.0, -1.0)),
            f32::INFINITY
        );
    }
}
