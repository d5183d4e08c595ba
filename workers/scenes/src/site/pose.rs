//! World directions and rigid poses, in meters; x and y are along the seabed, z is up.

use imaging::vector::{Vec3, vec3};

pub(crate) const ZERO: Vec3 = vec3(0.0, 0.0, 0.0);
pub(crate) const UP: Vec3 = vec3(0.0, 0.0, 1.0);

pub(crate) const fn up(height: f32) -> Vec3 {
    vec3(0.0, 0.0, height)
}

/// A horizontal unit vector, `azimuth` radians from x towards y.
pub(crate) fn horizontal(azimuth: f32) -> Vec3 {
    let (sin, cos) = libm::sincosf(azimuth);
    vec3(cos, sin, 0.0)
}

/// A right-handed frame of a solid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pose {
    pub(crate) origin: Vec3,
    pub(crate) axes: [Vec3; 3],
}

impl Pose {
    /// Upright, with its x axis `yaw` radians from the world's.
    pub(crate) fn upright(origin: Vec3, yaw: f32) -> Self {
        let x = horizontal(yaw);
        Self {
            origin,
            axes: [x, UP.cross(x), UP],
        }
    }

    /// With z from `a` to `b` and x rotated by `roll` radians about it.
    pub(crate) fn pointing(a: Vec3, b: Vec3, roll: f32) -> Self {
        let z = (b - a).normalized();
        let (sin, cos) = libm::sincosf(roll);
        let helper = if z.z.abs() < 0.9 { UP } else { vec3(1.0, 0.0, 0.0) };
        let side = helper.cross(z).normalized();
        let x = side * cos + z.cross(side) * sin;
        Self {
            origin: a,
            axes: [x, z.cross(x), z],
        }
    }

    /// World direction in this frame.
    #[inline(always)]
    pub(crate) fn direction_in(&self, world: Vec3) -> Vec3 {
        self.axes.map(|axis| axis.dot(world)).into()
    }

    /// World point in this frame.
    #[inline(always)]
    pub(crate) fn point_in(&self, world: Vec3) -> Vec3 {
        self.direction_in(world - self.origin)
    }

    /// Point of this frame in the world.
    pub(crate) fn point_out(&self, local: Vec3) -> Vec3 {
        self.origin + (self.axes[0] * local.x + self.axes[1] * local.y + self.axes[2] * local.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_survives_the_way_into_a_frame_and_out_again() {
        let pose = Pose::pointing(vec3(1.0, -2.0, 0.5), vec3(0.2, 1.0, 3.0), 1.1);
        let point = vec3(0.3, 4.0, -1.0);
        assert!((pose.point_out(pose.point_in(point)) - point).length() < 1e-5);
        assert!(pose.axes[0].cross(pose.axes[1]).dot(pose.axes[2]) > 0.999);
    }
}
