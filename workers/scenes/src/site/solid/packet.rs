//! Occlusion tests for packets of shadow rays, and single rays. A solid does not block a ray that starts inside it.

use imaging::vector::Vec3;
use imaging::vectorized;

use super::shape::ShapeGeometry;
use super::{Ring, Solid, SolidShape, ring};
use crate::site::bounds::Bounds;
use crate::site::lanes::{larger, load, smaller};
use crate::site::pose::Pose;

/// Rays per packet: those of a square of eight pixels a side.
pub(crate) const RUN: usize = 64;
/// Rays per group, tested or left out together. The compiler unrolls loops over eight rays instead of vectorizing them.
const GROUP: usize = 16;
/// Components of directions closer to 0 count as this, so that no product with their inverse is NaN.
const LEAST_WAY: f32 = 1e-20;

/// A packet of shadow rays in world coordinates.
pub(crate) struct ShadowPacket {
    /// Origins.
    pub(crate) from: [[f32; RUN]; 3],
    /// Vectors to the ends.
    pub(crate) way: [[f32; RUN]; 3],
    /// The inverse of each of their components.
    inverse: [[f32; RUN]; 3],
    /// 1 if occluded, else 0.
    pub(crate) occluded: [f32; RUN],
}

/// Some groups of a packet, one bit each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Groups(u8);

impl Groups {
    pub(crate) const ALL: Self = Self((1 << (RUN / GROUP)) - 1);

    pub(crate) fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The index of the first ray of each group.
    #[inline(always)]
    fn starts(self) -> impl Iterator<Item = usize> {
        (0..RUN / GROUP)
            .filter(move |group| self.0 >> group & 1 == 1)
            .map(|group| group * GROUP)
    }
}

impl ShadowPacket {
    pub(crate) fn blank() -> Self {
        Self {
            from: [[0.0; RUN]; 3],
            way: [[0.0; RUN]; 3],
            inverse: [[0.0; RUN]; 3],
            occluded: [0.0; RUN],
        }
    }

    /// Completes a packet after its rays are set.
    #[inline(always)]
    pub(crate) fn invert_ways(&mut self) {
        for (inverse, way) in self.inverse.iter_mut().zip(&self.way) {
            for (inverse, way) in inverse.iter_mut().zip(way) {
                let way = if way.abs() < LEAST_WAY { LEAST_WAY } else { *way };
                *inverse = 1.0 / way;
            }
        }
    }

    /// Those of the groups with a ray through a box that is not occluded.
    #[inline(always)]
    pub(crate) fn reach(&self, bounds: &Bounds, groups: Groups) -> Groups {
        let Bounds { low, high } = *bounds;
        let mut reaching = 0;
        for first in groups.starts() {
            let mut is_reached = 0;
            for k in 0..GROUP {
                let i = first + k;
                let (from, inverse) = (load(&self.from, i), load(&self.inverse, i));
                let a = (low - from).zip(inverse, |v, w| v * w);
                let b = (high - from).zip(inverse, |v, w| v * w);
                let (near, far) = (a.zip(b, smaller), a.zip(b, larger));
                let enter = larger(larger(near.x, near.y), larger(near.z, 0.0));
                let leave = smaller(smaller(far.x, far.y), smaller(far.z, 1.0));
                is_reached |= u32::from((enter <= leave) & (self.occluded[i] == 0.0));
            }
            reaching |= (is_reached as u8) << (first / GROUP);
        }
        Groups(reaching)
    }
}

impl Solid {
    /// Marks the rays of some groups behind this solid.
    pub(crate) fn occlude(&self, run: &mut ShadowPacket, groups: Groups) {
        let pose = &self.pose;
        match &self.shape {
            SolidShape::Ring(ring) => vectorized!(hide_behind_ring(ring, pose, run, groups)),
            shape => for_form!(shape, form => vectorized!(hide_behind(form, pose, run, groups))),
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
fn hide_behind(form: &impl ShapeGeometry, pose: &Pose, run: &mut ShadowPacket, groups: Groups) {
    let pose = *pose;
    for first in groups.starts() {
        for k in 0..GROUP {
            let i = first + k;
            let (o, d) = (
                pose.point_in(load(&run.from, i)),
                pose.direction_in(load(&run.way, i)),
            );
            let met = form.enter(o, d) < 1.0;
            run.occluded[i] = if met { 1.0 } else { run.occluded[i] };
        }
    }
}

#[inline(always)]
fn hide_behind_ring(ring: &Ring, pose: &Pose, run: &mut ShadowPacket, groups: Groups) {
    let (ring, pose) = (*ring, *pose);
    for first in groups.starts() {
        for start in (first..first + GROUP).step_by(ring::WIDE) {
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
}
