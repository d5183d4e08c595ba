//! The solids that sites are built of: where a ray enters each, how far a point is from it, its normal and its box.
//! A ray that misses enters at infinity. Eyes are outside every solid.

mod ball;
mod block;
mod bore;
mod ring;
mod room;
mod stone;
#[cfg(test)]
mod tests;
mod tube;

use imaging::vector::Vec3;
use imaging::vectorized;

use super::bounds::Bounds;
use super::lanes::{LANES, Lane, Lane3, larger, load, store};
use super::pose::Pose;

pub(crate) use ball::Ball;
pub(crate) use block::Block;
pub(crate) use bore::Bore;
pub(crate) use ring::Ring;
pub(crate) use room::Room;
pub(crate) use stone::Stone;
pub(crate) use tube::Tube;

/// What a form knows in its own frame, in meters. The functions of points and rays are inlined into loops over many of them.
trait Form {
    /// The parameter at which the ray from `o` along `d` meets the surface first, infinite if it does not.
    fn enter(&self, o: Vec3, d: Vec3) -> f32;
    /// Signed distance of a point from the surface, as [`Solid::approach`] describes it.
    fn distance(&self, p: Vec3) -> f32;
    /// Unit normal at a point of the surface and how close the point is to an edge, 0..1; see [`Solid::normals`].
    fn normal(&self, p: Vec3, bevel: f32) -> (Vec3, f32);
    /// A box around the solid, or around its hollow.
    fn bounds(&self) -> Bounds;
}

/// Declares the forms, and `for_form!`: a loop over points or rays, compiled for each form and for the vector instructions of
/// this CPU.
macro_rules! forms {
    ($dollar:tt $($Form:ident),*) => {
        /// Form and measures of a solid in its own frame.
        #[derive(Debug, Clone, Copy)]
        pub(crate) enum Shape {
            $($Form($Form)),*
        }

        $(impl From<$Form> for Shape {
            fn from(form: $Form) -> Self {
                Self::$Form(form)
            }
        })*

        macro_rules! for_form {
            ($dollar shape:expr, $dollar form:ident => $dollar work:expr) => {
                match $dollar shape {
                    $(Shape::$Form($dollar form) => $dollar work),*
                }
            };
        }
    };
}

forms!($ Tube, Block, Ball, Stone, Ring, Bore, Room);

mod ways;

pub(crate) use ways::{RUN, Run};

/// A solid in the scene.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Solid {
    pub(crate) shape: Shape,
    pub(crate) pose: Pose,
    /// The object that it is a part of; 0 is the ground.
    pub(crate) object: u16,
}

/// Rays from one eye: ray `i` is `first + step * i`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rays {
    pub(crate) eye: Vec3,
    pub(crate) first: Vec3,
    pub(crate) step: Vec3,
}

/// The nearest surface so far for each of a run of rays: the ray parameter, infinite if there is none, and whose.
pub(crate) struct Nearest<'a> {
    pub(crate) parameter: &'a mut [f32],
    pub(crate) owner: &'a mut [u16],
}

impl Solid {
    /// Takes over the rays that meet this solid first.
    pub(crate) fn meet(&self, rays: &Rays, mut nearest: Nearest<'_>, owner: u16) {
        let rays = Rays {
            eye: self.pose.point_in(rays.eye),
            first: self.pose.direction_in(rays.first),
            step: self.pose.direction_in(rays.step),
        };
        let nearest = &mut nearest;
        match &self.shape {
            Shape::Ring(ring) => vectorized!(march(ring, &rays, nearest, owner)),
            shape => for_form!(shape, form => vectorized!(take(form, &rays, nearest, owner))),
        }
    }

    /// Lowers each of `distances` to the distance in meters of its point from the surface; for balls and stones a lower bound
    /// of about the right size, no less than the distance from its box.
    pub(crate) fn approach(&self, points: &Lane3, distances: &mut Lane) {
        let pose = &self.pose;
        for_form!(&self.shape, form => vectorized!(lower(form, pose, points, distances)));
    }

    /// The distance in meters of a point of the world from the surface, as [`Solid::approach`] has it.
    pub(crate) fn distance(&self, point: Vec3) -> f32 {
        let local = self.pose.point_in(point);
        for_form!(&self.shape, form => form.distance(local))
    }

    /// Unit normals of points on the surface, in this solid's frame, and how close each is to an edge, 0..1.
    /// Edges are rounded over `bevel` meters in the normal only.
    pub(crate) fn normals(&self, local: &Lane3, bevel: f32, normals: &mut Lane3, edge: &mut Lane) {
        for_form!(&self.shape, form => vectorized!(orient(form, local, bevel, normals, edge)));
    }

    /// Whether the solid is what lies around a hollow.
    pub(crate) fn is_hollow(&self) -> bool {
        matches!(self.shape, Shape::Bore(_) | Shape::Room(_))
    }

    /// The eight corners, in the world, of a box around the solid, or around its hollow; bit k of the number says low or high on axis k.
    pub(crate) fn corners(&self) -> [Vec3; 8] {
        let Bounds { low, high } = for_form!(&self.shape, form => form.bounds());
        let ends: [[f32; 3]; 2] = [low.into(), high.into()];
        std::array::from_fn(|i| {
            let corner = [0, 1, 2].map(|axis| ends[i >> axis & 1][axis]);
            self.pose.point_out(corner.into())
        })
    }
}

/// The distance of a point from a box about the origin; negative inside.
#[inline(always)]
fn beyond_box(p: Vec3, half: Vec3) -> f32 {
    let away = p.zip(half, |p, half| larger(p.abs() - half, 0.0)).length();
    if away > 0.0 { away } else { f32::NEG_INFINITY }
}

#[inline(always)]
fn take(form: &impl Form, rays: &Rays, nearest: &mut Nearest<'_>, owner: u16) {
    let Rays { eye, first, step } = *rays;
    let (parameters, owners) = (&mut *nearest.parameter, &mut *nearest.owner);
    for (i, (parameter, held)) in parameters.iter_mut().zip(owners.iter_mut()).enumerate() {
        let found = form.enter(eye, first + step * (i as i32 as f32));
        let closer = found < *parameter;
        *parameter = if closer { found } else { *parameter };
        *held = if closer { owner } else { *held };
    }
}

/// [`take`] for a ring, whose rays march side by side.
#[inline(always)]
fn march(ring: &Ring, rays: &Rays, nearest: &mut Nearest<'_>, owner: u16) {
    let Rays { eye, first, step } = *rays;
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
fn lower(form: &impl Form, pose: &Pose, points: &Lane3, distances: &mut Lane) {
    let pose = *pose;
    for i in 0..LANES {
        let found = form.distance(pose.point_in(load(points, i)));
        distances[i] = if found < distances[i] { found } else { distances[i] };
    }
}

#[inline(always)]
fn orient(form: &impl Form, local: &Lane3, bevel: f32, normals: &mut Lane3, edge: &mut Lane) {
    for i in 0..LANES {
        let (normal, closeness) = form.normal(load(local, i), bevel);
        store(normals, i, normal);
        edge[i] = closeness;
    }
}
