//! The solids that sites are built of. Each knows where a ray enters it, how far a point is from it, its
//! normal and its box. A ray that misses enters at infinity. Eyes are outside every solid.

mod ball;
mod block;
mod bore;
#[cfg(test)]
pub(crate) mod reference;
mod ring;
mod room;
mod stone;
mod tube;

use imaging::simd::vectorised;

use super::lanes::{LANES, Lane, Lane3, larger};
use super::vector::{Pose, Vec3, vec3};

pub(crate) use ball::Ball;
pub(crate) use block::Block;
pub(crate) use bore::Bore;
pub(crate) use ring::Ring;
pub(crate) use room::Room;
pub(crate) use stone::Stone;
pub(crate) use tube::Tube;

/// Form and measures of a solid in its own frame.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Shape {
    Tube(Tube),
    Block(Block),
    Ball(Ball),
    Stone(Stone),
    Ring(Ring),
    Bore(Bore),
    Room(Room),
}

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

/// Runs a loop over points or rays, compiled for each shape and for the vector instructions of this CPU.
macro_rules! for_shape {
    ($shape:expr, $form:ident => $work:expr) => {
        match $shape {
            Shape::Tube($form) => vectorised(
                #[inline(always)]
                || $work,
            ),
            Shape::Block($form) => vectorised(
                #[inline(always)]
                || $work,
            ),
            Shape::Ball($form) => vectorised(
                #[inline(always)]
                || $work,
            ),
            Shape::Stone($form) => vectorised(
                #[inline(always)]
                || $work,
            ),
            Shape::Ring($form) => vectorised(
                #[inline(always)]
                || $work,
            ),
            Shape::Bore($form) => vectorised(
                #[inline(always)]
                || $work,
            ),
            Shape::Room($form) => vectorised(
                #[inline(always)]
                || $work,
            ),
        }
    };
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
        /// Rays one by one, for shapes whose entry is a formula.
        macro_rules! one_by_one {
            ($form:expr) => {
                vectorised(
                    #[inline(always)]
                    || {
                        take(
                            &rays,
                            nearest,
                            owner,
                            #[inline(always)]
                            |o, d| $form.enter(o, d),
                        )
                    },
                )
            };
        }
        match &self.shape {
            Shape::Tube(tube) => one_by_one!(tube),
            Shape::Block(block) => one_by_one!(block),
            Shape::Ball(ball) => one_by_one!(ball),
            Shape::Stone(stone) => one_by_one!(stone),
            Shape::Bore(bore) => one_by_one!(bore),
            Shape::Room(room) => one_by_one!(room),
            Shape::Ring(ring) => vectorised(
                #[inline(always)]
                || march(&rays, nearest, owner, ring),
            ),
        }
    }

    /// Lowers each of `distances` to the distance in metres of its point from the surface; for balls and stones a lower bound
    /// of about the right size, no less than the distance from [`Solid::bounds`].
    pub(crate) fn approach(&self, points: &Lane3, distances: &mut Lane) {
        let pose = &self.pose;
        for_shape!(&self.shape, form => lower(
            pose,
            points,
            distances,
            #[inline(always)]
            |p| form.distance(p),
        ));
    }

    /// The distance in metres of a point of the world from the surface, as [`Solid::approach`] has it.
    pub(crate) fn distance(&self, point: Vec3) -> f32 {
        let mut distances = [f32::INFINITY; LANES];
        self.approach(
            &[[point.x; LANES], [point.y; LANES], [point.z; LANES]],
            &mut distances,
        );
        distances[0]
    }

    /// Unit normals of points on the surface, in this solid's frame, and how close each is to an edge, 0..1.
    /// Edges are rounded over `bevel` metres in the normal only.
    pub(crate) fn normals(&self, local: &Lane3, bevel: f32, normals: &mut Lane3, edge: &mut Lane) {
        for_shape!(&self.shape, form => orient(
            local,
            normals,
            edge,
            #[inline(always)]
            |p| form.normal(p, bevel),
        ));
    }

    /// Lowest and highest corner of a box around the solid, in its own frame; of hollow ones, around the hollow.
    pub(crate) fn bounds(&self) -> (Vec3, Vec3) {
        match &self.shape {
            Shape::Tube(tube) => tube.bounds(),
            Shape::Block(block) => (-block.half, block.half),
            Shape::Ball(ball) => (-ball.radii, ball.radii),
            Shape::Stone(stone) => stone.bounds(),
            Shape::Ring(ring) => ring.bounds(),
            Shape::Bore(bore) => bore.bounds(),
            Shape::Room(room) => (-room.half, room.half),
        }
    }

    /// Whether the solid is what lies around a hollow.
    pub(crate) fn is_hollow(&self) -> bool {
        matches!(self.shape, Shape::Bore(_) | Shape::Room(_))
    }

    /// The eight corners of [`Solid::bounds`], in the world; bit k of the number says low or high on axis k.
    pub(crate) fn corners(&self) -> [Vec3; 8] {
        let (low, high) = self.bounds();
        std::array::from_fn(|i| {
            let side = |bit: usize, low: f32, high: f32| if i >> bit & 1 == 0 { low } else { high };
            self.pose.point_out(vec3(
                side(0, low.x, high.x),
                side(1, low.y, high.y),
                side(2, low.z, high.z),
            ))
        })
    }
}

/// The distance of a point from a box about the origin; negative inside.
#[inline(always)]
fn beyond_box(p: Vec3, half: Vec3) -> f32 {
    let out = |p: f32, half: f32| larger(p.abs() - half, 0.0);
    let away = vec3(out(p.x, half.x), out(p.y, half.y), out(p.z, half.z)).length();
    if away > 0.0 { away } else { f32::NEG_INFINITY }
}

#[inline(always)]
fn take(rays: &Rays, nearest: &mut Nearest<'_>, owner: u16, enter: impl Fn(Vec3, Vec3) -> f32) {
    let Rays { eye, first, step } = *rays;
    let (parameters, owners) = (&mut *nearest.parameter, &mut *nearest.owner);
    for (i, (parameter, held)) in parameters.iter_mut().zip(owners.iter_mut()).enumerate() {
        let found = enter(eye, first + step * (i as i32 as f32));
        let closer = found < *parameter;
        *parameter = if closer { found } else { *parameter };
        *held = if closer { owner } else { *held };
    }
}

/// [`take`] for a ring.
#[inline(always)]
fn march(rays: &Rays, nearest: &mut Nearest<'_>, owner: u16, ring: &Ring) {
    let Rays { eye, first, step } = *rays;
    let ring = *ring;
    for start in (0..nearest.parameter.len()).step_by(ring::WIDE) {
        let ray = |i: usize| first + step * ((start + i) as i32 as f32);
        let found = ring.enter(eye, std::array::from_fn(ray));
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
fn lower(pose: &Pose, points: &Lane3, distances: &mut Lane, distance: impl Fn(Vec3) -> f32) {
    let pose = *pose;
    for i in 0..LANES {
        let found = distance(pose.point_in(vec3(points[0][i], points[1][i], points[2][i])));
        distances[i] = if found < distances[i] { found } else { distances[i] };
    }
}

#[inline(always)]
fn orient(local: &Lane3, normals: &mut Lane3, edge: &mut Lane, normal: impl Fn(Vec3) -> (Vec3, f32)) {
    for i in 0..LANES {
        let (n, closeness) = normal(vec3(local[0][i], local[1][i], local[2][i]));
        normals[0][i] = n.x;
        normals[1][i] = n.y;
        normals[2][i] = n.z;
        edge[i] = closeness;
    }
}
