//! The solids that structures are built of. Each knows where a ray enters it, how far a point is from it, its
//! normal and its box. A ray that misses enters at infinity. Eyes are outside every solid.

mod ball;
mod block;
mod ring;
mod stone;
mod tube;

use imaging::simd::vectorised;

use super::lanes::{LANES, Lane3};
use super::vector::{Pose, Vec3, vec3};

pub(super) use ball::Ball;
pub(super) use block::Block;
pub(super) use ring::Ring;
pub(super) use stone::Stone;
pub(super) use tube::Tube;

/// Form and measures of a solid in its own frame.
#[derive(Debug, Clone, Copy)]
pub(super) enum Shape {
    Tube(Tube),
    Block(Block),
    Ball(Ball),
    Stone(Stone),
    Ring(Ring),
}

/// A solid in the scene.
#[derive(Debug, Clone, Copy)]
pub(super) struct Solid {
    pub shape: Shape,
    pub pose: Pose,
    /// Index of its finish in the site's list.
    pub finish: usize,
    /// Number of the object that it is a part of, from 0.
    pub object: u16,
}

/// Rays from one eye: ray `i` is `first + step * i`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rays {
    pub eye: Vec3,
    pub first: Vec3,
    pub step: Vec3,
}

/// The nearest surface so far for each of a run of rays: the ray parameter, infinite if there is none, and whose.
pub(super) struct Nearest<'a> {
    pub parameter: &'a mut [f32],
    pub owner: &'a mut [u16],
}

impl Solid {
    /// Takes over the rays that meet this solid first.
    pub(super) fn meet(&self, rays: &Rays, mut nearest: Nearest<'_>, owner: u16) {
        let rays = Rays {
            eye: self.pose.point_in(rays.eye),
            first: self.pose.direction_in(rays.first),
            step: self.pose.direction_in(rays.step),
        };
        match &self.shape {
            Shape::Tube(tube) => vectorised(
                #[inline(always)]
                || {
                    take(
                        &rays,
                        &mut nearest,
                        owner,
                        #[inline(always)]
                        |o, d| tube.enter(o, d),
                    )
                },
            ),
            Shape::Block(block) => vectorised(
                #[inline(always)]
                || {
                    take(
                        &rays,
                        &mut nearest,
                        owner,
                        #[inline(always)]
                        |o, d| block.enter(o, d),
                    )
                },
            ),
            Shape::Ball(ball) => vectorised(
                #[inline(always)]
                || {
                    take(
                        &rays,
                        &mut nearest,
                        owner,
                        #[inline(always)]
                        |o, d| ball.enter(o, d),
                    )
                },
            ),
            Shape::Stone(stone) => vectorised(
                #[inline(always)]
                || {
                    take(
                        &rays,
                        &mut nearest,
                        owner,
                        #[inline(always)]
                        |o, d| stone.enter(o, d),
                    )
                },
            ),
            Shape::Ring(ring) => vectorised(
                #[inline(always)]
                || {
                    take(
                        &rays,
                        &mut nearest,
                        owner,
                        #[inline(always)]
                        |o, d| ring.enter(o, d),
                    )
                },
            ),
        }
    }

    /// Lowers each of `distances` to the distance in metres of its point from the surface; for balls and stones a lower bound
    /// of about the right size.
    pub(super) fn approach(&self, points: &Lane3, distances: &mut [f32; LANES]) {
        let pose = &self.pose;
        match &self.shape {
            Shape::Tube(tube) => vectorised(
                #[inline(always)]
                || {
                    lower(
                        pose,
                        points,
                        distances,
                        #[inline(always)]
                        |p| tube.distance(p),
                    )
                },
            ),
            Shape::Block(block) => vectorised(
                #[inline(always)]
                || {
                    lower(
                        pose,
                        points,
                        distances,
                        #[inline(always)]
                        |p| block.distance(p),
                    )
                },
            ),
            Shape::Ball(ball) => vectorised(
                #[inline(always)]
                || {
                    lower(
                        pose,
                        points,
                        distances,
                        #[inline(always)]
                        |p| ball.distance(p),
                    )
                },
            ),
            Shape::Stone(stone) => vectorised(
                #[inline(always)]
                || {
                    lower(
                        pose,
                        points,
                        distances,
                        #[inline(always)]
                        |p| stone.distance(p),
                    )
                },
            ),
            Shape::Ring(ring) => vectorised(
                #[inline(always)]
                || {
                    lower(
                        pose,
                        points,
                        distances,
                        #[inline(always)]
                        |p| ring.distance(p),
                    )
                },
            ),
        }
    }

    /// Unit normals of points on the surface, in this solid's frame, and how close each is to an edge, 0..1.
    /// Edges are rounded over `bevel` metres in the normal only.
    pub(super) fn normals(&self, local: &Lane3, bevel: f32, normals: &mut Lane3, edge: &mut [f32; LANES]) {
        match &self.shape {
            Shape::Tube(tube) => vectorised(
                #[inline(always)]
                || {
                    orient(
                        local,
                        normals,
                        edge,
                        #[inline(always)]
                        |p| tube.normal(p, bevel),
                    )
                },
            ),
            Shape::Block(block) => vectorised(
                #[inline(always)]
                || {
                    orient(
                        local,
                        normals,
                        edge,
                        #[inline(always)]
                        |p| block.normal(p, bevel),
                    )
                },
            ),
            Shape::Ball(ball) => vectorised(
                #[inline(always)]
                || {
                    orient(
                        local,
                        normals,
                        edge,
                        #[inline(always)]
                        |p| (ball.normal(p), 0.0),
                    )
                },
            ),
            Shape::Stone(stone) => vectorised(
                #[inline(always)]
                || {
                    orient(
                        local,
                        normals,
                        edge,
                        #[inline(always)]
                        |p| stone.normal(p, bevel),
                    )
                },
            ),
            Shape::Ring(ring) => vectorised(
                #[inline(always)]
                || {
                    orient(
                        local,
                        normals,
                        edge,
                        #[inline(always)]
                        |p| (ring.normal(p), 0.0),
                    )
                },
            ),
        }
    }

    /// The eight corners of a box around the solid, in the world; bit k of the number says low or high on axis k.
    pub(super) fn corners(&self) -> [Vec3; 8] {
        let (low, high) = match &self.shape {
            Shape::Tube(tube) => tube.bounds(),
            Shape::Block(block) => (-block.half, block.half),
            Shape::Ball(ball) => (-ball.radii, ball.radii),
            Shape::Stone(stone) => stone.bounds(),
            Shape::Ring(ring) => ring.bounds(),
        };
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

#[inline(always)]
fn take(rays: &Rays, nearest: &mut Nearest<'_>, owner: u16, enter: impl Fn(Vec3, Vec3) -> f32) {
    let Nearest {
        parameter,
        owner: owners,
    } = nearest;
    for (i, (parameter, held)) in parameter.iter_mut().zip(owners.iter_mut()).enumerate() {
        let found = enter(rays.eye, rays.first + rays.step * (i as i32 as f32));
        let closer = found < *parameter;
        *parameter = if closer { found } else { *parameter };
        *held = if closer { owner } else { *held };
    }
}

#[inline(always)]
fn lower(pose: &Pose, points: &Lane3, distances: &mut [f32; LANES], distance: impl Fn(Vec3) -> f32) {
    for i in 0..LANES {
        let found = distance(pose.point_in(vec3(points[0][i], points[1][i], points[2][i])));
        distances[i] = if found < distances[i] { found } else { distances[i] };
    }
}

#[inline(always)]
fn orient(local: &Lane3, normals: &mut Lane3, edge: &mut [f32; LANES], normal: impl Fn(Vec3) -> (Vec3, f32)) {
    for i in 0..LANES {
        let (n, closeness) = normal(vec3(local[0][i], local[1][i], local[2][i]));
        normals[0][i] = n.x;
        normals[1][i] = n.y;
        normals[2][i] = n.z;
        edge[i] = closeness;
    }
}
