//! Vectors and rigid poses in metres; x and y lie in the seabed, z points up.

use std::ops::{Add, Mul, Neg, Sub};

/// A point or a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Vec3 {
    pub(crate) x: f32,
    pub(crate) y: f32,
    pub(crate) z: f32,
}

/// Shorthand for a [`Vec3`].
pub(crate) const fn vec3(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3 { x, y, z }
}

pub(crate) const ZERO: Vec3 = vec3(0.0, 0.0, 0.0);
pub(crate) const UP: Vec3 = vec3(0.0, 0.0, 1.0);

impl Vec3 {
    #[inline(always)]
    pub(crate) fn dot(self, other: Self) -> f32 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    pub(crate) fn cross(self, other: Self) -> Self {
        vec3(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }

    #[inline(always)]
    pub(crate) fn length(self) -> f32 {
        self.dot(self).sqrt()
    }

    /// The direction of a vector that is not zero.
    #[inline(always)]
    pub(crate) fn unit(self) -> Self {
        self * (1.0 / self.length())
    }

    /// Some unit vector at a right angle to this unit vector.
    pub(crate) fn aside(self) -> Self {
        let helper = if self.z.abs() < 0.9 {
            UP
        } else {
            vec3(1.0, 0.0, 0.0)
        };
        helper.cross(self).unit()
    }

    /// A horizontal unit vector, `azimuth` radians from x towards y.
    pub(crate) fn horizontal(azimuth: f32) -> Self {
        let (sin, cos) = libm::sincosf(azimuth);
        vec3(cos, sin, 0.0)
    }
}

impl Add for Vec3 {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        vec3(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl Sub for Vec3 {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        vec3(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl Mul<f32> for Vec3 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f32) -> Self {
        vec3(self.x * factor, self.y * factor, self.z * factor)
    }
}

impl Neg for Vec3 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self * -1.0
    }
}

/// A right-handed frame: where a solid stands and which way its axes point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pose {
    pub(crate) origin: Vec3,
    pub(crate) axes: [Vec3; 3],
}

impl Pose {
    /// Upright, its x axis `yaw` radians from the world's.
    pub(crate) fn upright(origin: Vec3, yaw: f32) -> Self {
        let x = Vec3::horizontal(yaw);
        Self {
            origin,
            axes: [x, UP.cross(x), UP],
        }
    }

    /// Its z axis points from `a` to `b`, its x axis is turned by `roll` radians about it.
    pub(crate) fn along(a: Vec3, b: Vec3, roll: f32) -> Self {
        let z = (b - a).unit();
        let (sin, cos) = libm::sincosf(roll);
        let side = z.aside();
        let x = side * cos + z.cross(side) * sin;
        Self {
            origin: a,
            axes: [x, z.cross(x), z],
        }
    }

    /// A direction of the world in this frame.
    #[inline(always)]
    pub(crate) fn direction_in(&self, world: Vec3) -> Vec3 {
        vec3(
            self.axes[0].dot(world),
            self.axes[1].dot(world),
            self.axes[2].dot(world),
        )
    }

    /// A point of the world in this frame.
    #[inline(always)]
    pub(crate) fn point_in(&self, world: Vec3) -> Vec3 {
        self.direction_in(world - self.origin)
    }

    /// A direction of this frame in the world.
    #[inline(always)]
    pub(crate) fn direction_out(&self, local: Vec3) -> Vec3 {
        self.axes[0] * local.x + self.axes[1] * local.y + self.axes[2] * local.z
    }

    /// A point of this frame in the world.
    #[inline(always)]
    pub(crate) fn point_out(&self, local: Vec3) -> Vec3 {
        self.origin + self.direction_out(local)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_survives_the_way_into_a_frame_and_out_again() {
        let pose = Pose::along(vec3(1.0, -2.0, 0.5), vec3(0.2, 1.0, 3.0), 1.1);
        let point = vec3(0.3, 4.0, -1.0);
        assert!((pose.point_out(pose.point_in(point)) - point).length() < 1e-5);
        assert!(pose.axes[0].cross(pose.axes[1]).dot(pose.axes[2]) > 0.999);
    }
}
