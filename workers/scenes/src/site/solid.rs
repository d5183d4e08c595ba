//! The solids of sites: ray intersection, distance, normal and bounding box. Misses enter at infinity. Eyes are outside
//! every solid.

mod ball;
mod block;
mod bore;
mod ring;
mod room;
mod shape;
mod stone;
#[cfg(test)]
mod tests;
mod tube;

use imaging::vector::Vec3;
use imaging::vectorized;

use super::bounds::{Bounds, EVERYWHERE_M};
use super::lanes::{LANES, Lane, Lane3, larger, load, smaller, store};
use super::pose::Pose;

pub(crate) use ball::Ellipsoid;
pub(crate) use block::SolidBox;
pub(crate) use bore::Bore;
pub(crate) use ring::Ring;
pub(crate) use room::Room;
pub(crate) use stone::Stone;
pub(crate) use tube::Tube;

/// Declares the shapes, and `for_form!`: a loop over points or rays, compiled for each shape and for this CPU's vector
/// instructions.
macro_rules! forms {
    ($dollar:tt $($ShapeGeometry:ident),*) => {
        /// SolidShape and dimensions of a solid in its frame.
        #[derive(Debug, Clone, Copy)]
        pub(crate) enum SolidShape {
            $($ShapeGeometry($ShapeGeometry)),*
        }

        $(impl From<$ShapeGeometry> for SolidShape {
            fn from(form: $ShapeGeometry) -> Self {
                Self::$ShapeGeometry(form)
            }
        })*

        macro_rules! for_form {
            ($dollar shape:expr, $dollar form:ident => $dollar work:expr) => {
                match $dollar shape {
                    $(SolidShape::$ShapeGeometry($dollar form) => $dollar work),*
                }
            };
        }
    };
}

forms!($ Tube, SolidBox, Ellipsoid, Stone, Ring, Bore, Room);

mod packet;

pub(crate) use packet::{Groups, RUN, ShadowPacket};
use shape::ShapeGeometry;

#[derive(Debug, Clone, Copy)]
pub(crate) struct Solid {
    pub(crate) shape: SolidShape,
    pub(crate) pose: Pose,
    /// Its object; 0 is the ground.
    pub(crate) object: u16,
}

/// EyeRays from one eye: ray `i` is `first + step * i`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EyeRays {
    pub(crate) eye: Vec3,
    pub(crate) first: Vec3,
    pub(crate) step: Vec3,
}

/// Nearest hit so far of each ray: the parameter, infinite for a miss, and the owner.
pub(crate) struct Nearest<'a> {
    pub(crate) parameter: &'a mut [f32],
    pub(crate) owner: &'a mut [u16],
}

impl Solid {
    /// Updates the rays whose nearest hit is this solid.
    pub(crate) fn meet(&self, rays: &EyeRays, mut nearest: Nearest<'_>, owner: u16) {
        let rays = EyeRays {
            eye: self.pose.point_in(rays.eye),
            first: self.pose.direction_in(rays.first),
            step: self.pose.direction_in(rays.step),
        };
        let nearest = &mut nearest;
        match &self.shape {
            SolidShape::Ring(ring) => vectorized!(march(ring, &rays, nearest, owner)),
            shape => for_form!(shape, form => vectorized!(take(form, &rays, nearest, owner))),
        }
    }

    /// Lowers each of `distances` to the distance in meters of its point from the surface. For balls and stones this is
    /// a lower bound of about the right size, at least the distance from the bounding box.
    pub(crate) fn approach(&self, points: &Lane3, distances: &mut Lane) {
        let pose = &self.pose;
        for_form!(&self.shape, form => vectorized!(lower(form, pose, points, distances)));
    }

    /// Distance in meters of a world point from the surface, with the bounds of [`Solid::approach`].
    pub(crate) fn distance(&self, point: Vec3) -> f32 {
        let local = self.pose.point_in(point);
        for_form!(&self.shape, form => form.distance(local))
    }

    /// Unit normals at surface points, in this solid's frame, and closeness of each to an edge, 0..1. Only the normals
    /// are rounded, over `bevel` meters.
    pub(crate) fn normals(&self, local: &Lane3, bevel: f32, normals: &mut Lane3, edge: &mut Lane) {
        for_form!(&self.shape, form => vectorized!(orient(form, local, bevel, normals, edge)));
    }

    /// Whether the solid surrounds a hollow.
    pub(crate) fn is_hollow(&self) -> bool {
        matches!(self.shape, SolidShape::Bore(_) | SolidShape::Room(_))
    }

    /// The eight corners of the bounding box (of the hollow, for hollows) in world coordinates; bit k of the index
    /// selects low or high on axis k.
    pub(crate) fn corners(&self) -> [Vec3; 8] {
        let Bounds { low, high } = for_form!(&self.shape, form => form.bounds());
        let ends: [[f32; 3]; 2] = [low.into(), high.into()];
        std::array::from_fn(|i| {
            let corner = [0, 1, 2].map(|axis| ends[i >> axis & 1][axis]);
            self.pose.point_out(corner.into())
        })
    }
}

impl Bounds {
    /// The box of a solid in world coordinates; for a hollow's wall, everything.
    pub(super) fn from_solid(solid: &Solid) -> Self {
        if solid.is_hollow() {
            return Self::half_space(EVERYWHERE_M);
        }
        let corners = solid.corners();
        Self {
            low: corners.into_iter().fold(corners[0], |a, b| a.zip(b, smaller)),
            high: corners.into_iter().fold(corners[0], |a, b| a.zip(b, larger)),
        }
    }
}

#[inline(always)]
fn take(form: &impl ShapeGeometry, rays: &EyeRays, nearest: &mut Nearest<'_>, owner: u16) {
    let EyeRays { eye, first, step } = *rays;
    let (parameters, owners) = (&mut *nearest.parameter, &mut *nearest.owner);
    for (i, (parameter, held)) in parameters.iter_mut().zip(owners.iter_mut()).enumerate() {
        let found = form.enter(eye, first + step * (i as i32 as f32));
        let closer = found < *parameter;
        *parameter = if closer { found } else { *parameter };
        *held = if closer { owner } else { *held };
    }
}

/// [`take`] for a ring; several rays march together.
#[inline(always)]
fn march(ring: &Ring, rays: &EyeRays, nearest: &mut Nearest<'_>, owner: u16) {
    let EyeRays { eye, first, step } = *rays;
    let ring = *ring;
    for start in (0..nearest.parameter.len()).step_by(ring::WIDE) {
        let ray = |i: usize| first + step * ((start + i) as i32 as f32);
        let found = ring.enter_abreast([eye; ring::WIDE], std::array::from_fn(ray));
        for (i, found) in found.into_iter().enumerate() {
            let Some(parameter) = nearest.parameter.get_mut(start + i) else {
                return;
            };
            if found < *parameter {
                *parameter = found;
                nearest.owner[start + i] = owner;
            }
        }
    }
}

#[inline(always)]
fn lower(form: &impl ShapeGeometry, pose: &Pose, points: &Lane3, distances: &mut Lane) {
    let pose = *pose;
    for i in 0..LANES {
        let found = form.distance(pose.point_in(load(points, i)));
        distances[i] = if found < distances[i] { found } else { distances[i] };
    }
}

#[inline(always)]
fn orient(form: &impl ShapeGeometry, local: &Lane3, bevel: f32, normals: &mut Lane3, edge: &mut Lane) {
    for i in 0..LANES {
        let (normal, closeness) = form.normal(load(local, i), bevel);
        store(normals, i, normal);
        edge[i] = closeness;
    }
}
