//! Occlusion tests for packets of shadow rays, and single rays. A solid does not block a ray that starts inside it.

use imaging::vector::Vec3;
use imaging::vectorized;

use super::shape::ShapeGeometry;
use super::{Ring, Solid, SolidShape, ring};
use crate::site::lanes::load;
use crate::site::pose::Pose;

/// EyeRays per packet: those of a square of eight pixels a side.
pub(crate) const RUN: usize = 64;

/// A packet of shadow rays in world coordinates.
pub(crate) struct ShadowPacket {
    /// Origins.
    pub(crate) from: [[f32; RUN]; 3],
    /// Vectors to the ends.
    pub(crate) way: [[f32; RUN]; 3],
    /// 1 if occluded, else 0.
    pub(crate) occluded: [f32; RUN],
}

impl Solid {
    /// Marks the rays occluded by this solid.
    pub(crate) fn occlude(&self, run: &mut ShadowPacket) {
        let pose = &self.pose;
        match &self.shape {
            SolidShape::Ring(ring) => vectorized!(hide_behind_ring(ring, pose, run)),
            shape => for_form!(shape, form => vectorized!(hide_behind(form, pose, run))),
        }
    }

    /// Entry parameter of a world ray, in lengths of its direction; infinite for a miss.
    pub(crate) fn enter(&self, origin: Vec3, direction: Vec3) -> f32 {
        let (o, d) = (self.pose.point_in(origin), self.pose.direction_in(direction));
        match &self.shape {
            SolidShape::Ring(ring) => {
                let met = ring.enter(o, d);
                if met.is_finite() && ring.is_entered(o + d * met, d) {
                    met
                } else {
                    f32::INFINITY
                }
            }
            shape => for_form!(shape, form => form.enter(o, d)),
        }
    }

    /// The unit normal in the world at a point of the surface. Edges are rounded over `bevel` meters.
    pub(crate) fn normal(&self, point: Vec3, bevel: f32) -> Vec3 {
        let local = self.pose.point_in(point);
        let (normal, _) = for_form!(&self.shape, form => form.normal(local, bevel));
        let [x, y, z] = self.pose.axes;
        x * normal.x + y * normal.y + z * normal.z
    }
}

#[inline(always)]
fn hide_behind(form: &impl ShapeGeometry, pose: &Pose, run: &mut ShadowPacket) {
    let pose = *pose;
    for i in 0..RUN {
        let (o, d) = (
            pose.point_in(load(&run.from, i)),
            pose.direction_in(load(&run.way, i)),
        );
        let met = form.enter(o, d) < 1.0;
        run.occluded[i] = if met { 1.0 } else { run.occluded[i] };
    }
}

#[inline(always)]
fn hide_behind_ring(ring: &Ring, pose: &Pose, run: &mut ShadowPacket) {
    let (ring, pose) = (*ring, *pose);
    for start in (0..RUN).step_by(ring::WIDE) {
        let o = std::array::from_fn(|i| pose.point_in(load(&run.from, start + i)));
        let d = std::array::from_fn(|i| pose.direction_in(load(&run.way, start + i)));
        let met = ring.enter_abreast(o, d);
        for i in 0..ring::WIDE {
            if met[i] < 1.0 && ring.is_entered(o[i] + d[i] * met[i], d[i]) {
                run.occluded[start + i] = 1.0;
            }
        }
    }
}
