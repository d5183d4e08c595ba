//! Where rays enter solids, slowly and in f64, by other formulas than the fast ones where there are others.

use super::{Ring, Shape, Solid};
use crate::pose::{add, cross, dot, length, scale, sub};
use crate::site::vector::Vec3;

type Vector = [f64; 3];

fn wide(v: Vec3) -> Vector {
    [v.x, v.y, v.z].map(f64::from)
}

/// The parameter at which the ray from `eye` along `ray` meets the solid first; infinite if it does not.
pub(crate) fn enter(solid: &Solid, eye: Vector, ray: Vector) -> f64 {
    let axes = solid.pose.axes.map(wide);
    let inward = |v: Vector| axes.map(|axis| dot(axis, v));
    let (o, d) = (inward(sub(eye, wide(solid.pose.origin))), inward(ray));
    let hits = match &solid.shape {
        Shape::Tube(tube) => {
            let (radius, top) = (f64::from(tube.radius), f64::from(tube.length));
            let side = circle(o, d, radius)
                .into_iter()
                .filter(|t| (0.0..=top).contains(&(o[2] + t * d[2])));
            let caps = [0.0, top].into_iter().map(|z| (z - o[2]) / d[2]).filter(|t| {
                let (x, y) = (o[0] + t * d[0], o[1] + t * d[1]);
                x * x + y * y <= radius * radius
            });
            side.chain(caps).collect()
        }
        Shape::Bore(bore) => {
            let top = f64::from(bore.length);
            let leave = circle(o, d, f64::from(bore.radius)).last().copied();
            leave
                .into_iter()
                .filter(|t| (0.0..=top).contains(&(o[2] + t * d[2])))
                .collect()
        }
        Shape::Block(block) => {
            let half = wide(block.half);
            faces(o, d, half)
                .filter(|&(t, axis)| (0..3).all(|k| k == axis || (o[k] + t * d[k]).abs() <= half[k]))
                .map(|(t, _)| t)
                .collect()
        }
        Shape::Room(room) => {
            let half = wide(room.half);
            let walls = faces(o, d, half).filter(|&(_, axis)| axis < 2);
            let leave = walls.map(|(t, _)| t).filter(|&t| t > 0.0);
            let leave = leave.fold(f64::INFINITY, f64::min);
            let open = (o[2] + leave * d[2]).abs() > half[2];
            if open { vec![] } else { vec![leave] }
        }
        Shape::Ball(ball) => {
            let radii = wide(ball.radii);
            let (o, d) = (
                [0, 1, 2].map(|k| o[k] / radii[k]),
                [0, 1, 2].map(|k| d[k] / radii[k]),
            );
            roots(dot(d, d), dot(o, d), dot(o, o) - 1.0)
        }
        Shape::Stone(stone) => {
            let planes: Vec<_> = stone
                .planes
                .iter()
                .map(|(normal, offset)| (wide(*normal), f64::from(*offset)))
                .collect();
            let hit = |(normal, offset): &(Vector, f64)| (offset - dot(*normal, o)) / dot(*normal, d);
            let inside = |t: f64| {
                let p = add(o, scale(d, t));
                planes
                    .iter()
                    .all(|(normal, offset)| dot(*normal, p) - offset <= 1e-9)
            };
            planes.iter().map(hit).filter(|&t| inside(t)).collect()
        }
        Shape::Ring(ring) => bend(ring, o, d).into_iter().collect(),
    };
    hits.into_iter()
        .filter(|&t| t > 0.0)
        .fold(f64::INFINITY, f64::min)
}

/// Roots of a t² + 2 b t + c.
fn roots(a: f64, b: f64, c: f64) -> Vec<f64> {
    let root = b * b - a * c;
    if root < 0.0 {
        return vec![];
    }
    vec![(-b - root.sqrt()) / a, (-b + root.sqrt()) / a]
}

fn circle(o: Vector, d: Vector, radius: f64) -> Vec<f64> {
    roots(
        d[0] * d[0] + d[1] * d[1],
        o[0] * d[0] + o[1] * d[1],
        o[0] * o[0] + o[1] * o[1] - radius * radius,
    )
}

fn faces(o: Vector, d: Vector, half: Vector) -> impl Iterator<Item = (f64, usize)> {
    (0..3).flat_map(move |axis| [-1.0, 1.0].map(|side| ((side * half[axis] - o[axis]) / d[axis], axis)))
}

/// The first change of sign of the distance along the ray, in steps of a part of the thickness, then bisected.
fn bend(ring: &Ring, o: Vector, d: Vector) -> Option<f64> {
    let (bend, tube) = (f64::from(ring.bend_radius), f64::from(ring.tube_radius));
    let [sin, cos] = ring.half_angle.map(f64::from);
    let reach = bend + tube;
    if length(cross(o, d)) / length(d) > reach {
        return None;
    }
    let distance = |t: f64| {
        let p = add(o, scale(d, t));
        let x = p[0].abs();
        let around = x.hypot(p[1]);
        let nearest = if cos * x > sin * p[1] {
            [sin * bend, cos * bend]
        } else {
            [x / around * bend, p[1] / around * bend]
        };
        length([x - nearest[0], p[1] - nearest[1], p[2]]) - tube
    };
    let middle = -dot(o, d) / dot(d, d);
    let (start, end) = (
        (middle - 1.01 * reach / length(d)).max(0.0),
        middle + reach / length(d),
    );
    let step = 0.02 * tube / length(d);
    let mut t = start;
    while t < end {
        if distance(t) <= 0.0 {
            let (mut low, mut high) = (t - step, t);
            for _ in 0..60 {
                let half = (low + high) / 2.0;
                if distance(half) > 0.0 {
                    low = half;
                } else {
                    high = half;
                }
            }
            return Some(high);
        }
        // Never past the surface: the distance is a lower bound.
        t += step.max(0.9 * distance(t) / length(d));
    }
    None
}
