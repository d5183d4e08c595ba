//! Nearest hits and occlusion tests in a procedural world.
//!
//! Rays intersect the rendered solids by the same single-precision formulas: the ray through the center of a pixel hits
//! the surface shown there, at its range. A ray that starts inside a solid leaves it unhindered. The ground ends 60 m
//! from the camera, as in pictures.

use imaging::rays::{Cuboid, Hit, OFFSET, Rays, ShadowRays};
use imaging::vector::{DVec3, Vec3};
use imaging::vectorized;

use crate::site::bounds::Bounds;
use crate::site::lanes::{load, store};
use crate::site::pits;
use crate::site::solid::{RUN, ShadowPacket};
use crate::site::tree::{RayPacket, Tree};
use crate::site::{FAR_M, LABEL_BEVEL_M, Site};
use crate::{CameraPose, World};

/// Number of packets traced together: the rays from the same points to the first samples of a lamp's disc.
const TOGETHER: usize = 5;
/// Longer rays are clipped to this length, m; larger than any site.
const LONGEST_M: f64 = 1e3;

/// A world in the axes of a camera. SiteObject numbers are those of the world; 0 is the ground.
pub struct WorldRays<'a> {
    site: &'a Site,
    pose: CameraPose,
    tree: &'a Tree,
}

impl World {
    /// This world for rays in the axes of a camera.
    #[must_use]
    pub fn rays(&self, pose: &CameraPose) -> WorldRays<'_> {
        WorldRays {
            site: &self.site,
            pose: *pose,
            tree: self.tree(),
        }
    }
}

impl Rays for WorldRays<'_> {
    fn hit(&self, origin: [f64; 3], direction: [f64; 3], from: f64, to: f64) -> Option<Hit> {
        let (origin, direction) = (DVec3::from(origin), DVec3::from(direction));
        let begin = self.place_in_world(origin + direction * from).as_f32();
        let heading = self.direction_in_world(direction).as_f32();
        let meters = (to.min(LONGEST_M) - from) as f32;
        let (met, owner) = self.nearest(begin, heading, meters)?;
        let place = begin + heading * met;
        let (normal, object) = match owner {
            Some(number) => {
                let solid = &self.site.solids[usize::from(number)];
                (solid.normal(place, LABEL_BEVEL_M), solid.object)
            }
            None => (pits::normal(&self.site.pits, place), 0),
        };
        // A rounded edge may face away from the ray; turn its normal back until it is perpendicular to the ray.
        let away = normal.dot(heading).max(0.0) * 1.001;
        let normal = (normal - heading * away).normalized().as_f64();
        let CameraPose {
            right, down, ahead, ..
        } = self.pose;
        Some(Hit {
            distance: from + f64::from(met),
            normal: [right, down, ahead].map(|axis| axis.dot(normal)),
            object: u32::from(object),
        })
    }

    fn may_occlude(&self, from: &Cuboid, to: &Cuboid) -> bool {
        let packet = RayPacket {
            from: self.bounds_in_world(from),
            to: self.bounds_in_world(to),
        };
        // Pits have walls outside of any bounding box.
        if packet.to.low.z <= 0.0 || !self.site.pits.is_empty() {
            return true;
        }
        let mut is_met = false;
        self.tree.search(&packet, |_| {
            is_met = true;
            -1.0
        });
        is_met
    }

    fn clearance(&self, place: [f64; 3]) -> f64 {
        let place = self.place_in_world(place.into()).as_f32();
        let solids = self.site.solids.iter().map(|solid| solid.distance(place));
        f64::from(solids.fold(place.z, f32::min).max(0.0))
    }

    fn trace_shadow_rays(&self, rays: &ShadowRays, clear: &mut [bool]) {
        let frame = CameraFrame {
            eye: self.pose.position_m.as_f32(),
            axes: [self.pose.right, self.pose.down, self.pose.ahead].map(DVec3::as_f32),
        };
        let mut packets: [ShadowPacket; TOGETHER] = std::array::from_fn(|_| ShadowPacket::blank());
        let (mut ends, mut listed) = ([[0.0; RUN]; 3], Vec::with_capacity(RUN));
        for (at, clear) in clear.chunks_mut(RUN * TOGETHER).enumerate() {
            let packets = &mut packets[..clear.len().div_ceil(RUN)];
            let mut hulls = [RayPacket::EMPTY; TOGETHER];
            for (k, (run, hull)) in packets.iter_mut().zip(&mut hulls).enumerate() {
                vectorized!(begin(frame, rays, (at * TOGETHER + k) * RUN, run, &mut ends));
                if !self.site.pits.is_empty() {
                    self.sink(run, &ends);
                }
                *hull = RayPacket {
                    from: vectorized!(Bounds::from_points(&run.from)),
                    to: vectorized!(Bounds::from_points(&ends)),
                };
            }
            let all = hulls[..packets.len()]
                .iter()
                .fold(RayPacket::EMPTY, |all, hull| all.union(hull));
            let (tree, solids) = (self.tree, &self.site.solids);
            let are_few = packets.len() > 1 && tree.list_few(&all, &mut listed);
            for ((run, hull), clear) in packets.iter_mut().zip(&hulls).zip(clear.chunks_mut(RUN)) {
                if are_few {
                    vectorized!(tree.occlude_listed(solids, (&listed, hull), run));
                } else {
                    vectorized!(tree.occlude(solids, hull, run));
                }
                for (clear, occluded) in clear.iter_mut().zip(&run.occluded) {
                    *clear = *occluded == 0.0;
                }
            }
        }
    }
}

impl WorldRays<'_> {
    fn direction_in_world(&self, direction: DVec3) -> DVec3 {
        let CameraPose {
            right, down, ahead, ..
        } = self.pose;
        right * direction.x + down * direction.y + ahead * direction.z
    }

    /// Clears shadow rays that pass through the mouth of a pit and marks those that hit its wall.
    fn sink(&self, run: &mut ShadowPacket, ends: &[[f32; RUN]; 3]) {
        for i in 0..RUN {
            let (begin, end) = (load(&run.from, i), load(ends, i));
            let is_between = pits::is_between(&self.site.pits, begin, end);
            run.occluded[i] = if is_between {
                run.occluded[i].max(f32::from(begin.z.min(end.z) < -1e-3))
            } else {
                0.0
            };
        }
    }

    /// The bounding box in world coordinates, enlarged by the possible rounding error.
    fn bounds_in_world(&self, cuboid: &Cuboid) -> Bounds {
        let corners = cuboid.corners().map(|corner| {
            let place = self.place_in_world(corner.into());
            let lost = (OFFSET * place.length().max(1.0)) as f32;
            Bounds::from_point(place.as_f32()).grown(lost)
        });
        corners.iter().fold(corners[0], |all, corner| all.union(corner))
    }

    fn place_in_world(&self, place: DVec3) -> DVec3 {
        self.pose.position_m + self.direction_in_world(place)
    }

    /// Distance along a unit vector to the nearest surface, and its solid (`None`: the ground).
    fn nearest(&self, begin: Vec3, heading: Vec3, meters: f32) -> Option<(f32, Option<u16>)> {
        if meters <= 0.0 {
            return None;
        }
        let (mut nearest, mut owner) = (meters, None);
        let mut is_met = false;
        let ground = -begin.z / heading.z;
        if begin.z > 0.0 && heading.z < 0.0 && ground <= nearest {
            let from_eye = begin + heading * ground - self.pose.position_m.as_f32();
            let ground = pits::sink(&self.site.pits, begin, heading, ground);
            if from_eye.length() < FAR_M && ground <= nearest {
                (nearest, is_met) = (ground, true);
            }
        }
        let packet = RayPacket {
            from: Bounds::from_point(begin),
            to: Bounds::from_point(begin + heading * meters),
        };
        self.tree.search(&packet, |number| {
            let met = self.site.solids[usize::from(number)].enter(begin, heading);
            // At equal distances the solid with the lowest number counts, so the order of the search does not matter.
            if met < nearest || (met == nearest && owner.is_some_and(|other| number < other)) {
                (nearest, owner, is_met) = (met, Some(number), true);
            }
            nearest / meters
        });
        is_met.then_some((nearest, owner))
    }
}

/// The camera in single precision.
#[derive(Clone, Copy)]
struct CameraFrame {
    eye: Vec3,
    axes: [Vec3; 3],
}

impl CameraFrame {
    #[inline(always)]
    fn rotate(&self, v: Vec3) -> Vec3 {
        let [right, down, ahead] = self.axes;
        right * v.x + down * v.y + ahead * v.z
    }
}

/// Transforms a packet of shadow rays into the world, offsets their origins off the surfaces, and marks those blocked
/// by the ground. The last ray fills the rest of the packet.
#[inline(always)]
fn begin(
    frame: CameraFrame,
    rays: &ShadowRays,
    first: usize,
    run: &mut ShadowPacket,
    ends: &mut [[f32; RUN]; 3],
) {
    let count = RUN.min(rays.len() - first);
    let mut local = [[[0.0f32; RUN]; 3]; 2];
    for (lanes, ends) in local.iter_mut().zip([&rays.from, &rays.to]) {
        for (lane, axis) in lanes.iter_mut().zip(ends) {
            lane[..count].copy_from_slice(&axis[first..first + count]);
            let last = lane[count - 1];
            lane[count..].fill(last);
        }
    }
    for i in 0..RUN {
        let [from, to] = [load(&local[0], i), load(&local[1], i)];
        let way = to - from;
        // The offset of `imaging::rays::offset`.
        let off = OFFSET as f32 * from.length().max(1.0);
        let share = (off / way.length().max(1e-30)).min(1.0);
        let start = from + way * share;
        let way = to - start;
        let (begin, way) = (frame.eye + frame.rotate(start), frame.rotate(way));
        let end = begin + way;
        store(&mut run.from, i, begin);
        store(&mut run.way, i, way);
        store(ends, i, end);
        let share = begin.z / (begin.z - end.z);
        let away = begin + way * share - frame.eye;
        let met = (begin.z > 0.0) & (end.z < 0.0) & (away.dot(away) < FAR_M * FAR_M);
        run.occluded[i] = if met { 1.0 } else { 0.0 };
    }
    run.invert_ways();
}
