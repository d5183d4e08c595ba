//! Reference intersections in f64, by different formulas where possible.

use imaging::geometry::Intrinsics;
use imaging::vector::{DVec3, vec3};

use super::{Ring, Solid, SolidShape};
use crate::{FAMILIES, World};

/// Allowed share of rays that graze an edge and hit another solid in f64.
const GRAZING: f64 = 0.002;
/// Single precision: seven digits of coordinates up to 60 m, and a march that ends 0.2 mm before a ring.
const RANGE_TOLERANCE: f64 = 5e-4;

#[test]
fn range_is_that_of_the_analytic_intersection_in_f64() {
    for family in FAMILIES {
        let (mut worst, mut grazing, mut met) = (0.0f64, 0, 0);
        for seed in 0..24 {
            let world = World::new(family, seed).unwrap();
            let (pose, lens) = (world.pose(), Intrinsics::centered(0.6 * 41.0, 41, 27));
            let range = world.render(&pose, (41, 27), &lens).range.unwrap();
            for y in 0..27 {
                for x in 0..41 {
                    let ray = lens.ray(x as f64, y as f64);
                    let ray = (pose.ahead + (pose.right * ray.x + pose.down * ray.y)).normalized();
                    let ground = -pose.position_m.z / ray.z;
                    let met_ground = ground > 0.0 && ground < 60.0;
                    let ground = if met_ground { ground } else { f64::INFINITY };
                    let entries = world
                        .site
                        .solids
                        .iter()
                        .map(|solid| enter(solid, pose.position_m, ray));
                    let wanted = entries.fold(ground, f64::min);
                    let found = f64::from(range.pixel(x, y));
                    if wanted == found {
                        continue;
                    }
                    met += 1;
                    let error = (found - wanted).abs() / wanted.min(found).max(1.0);
                    if error > RANGE_TOLERANCE || error.is_nan() {
                        grazing += 1;
                    } else {
                        worst = worst.max(error);
                    }
                }
            }
        }
        assert!(
            met > 1_000 && f64::from(grazing) < GRAZING * f64::from(met),
            "{family}: {met} rays, largest error {worst:.1e}, {grazing} grazing"
        );
    }
}

/// Parameter of the first hit of the ray from `eye` along `ray`; infinite for a miss.
fn enter(solid: &Solid, eye: DVec3, ray: DVec3) -> f64 {
    let inward = |v: DVec3| DVec3::from(solid.pose.axes.map(|axis| axis.as_f64().dot(v)));
    let (o, d) = (inward(eye - solid.pose.origin.as_f64()), inward(ray));
    let along = |t: f64| o + d * t;
    let hits = match &solid.shape {
        SolidShape::Tube(tube) => {
            let (radius, top) = (f64::from(tube.radius), f64::from(tube.length));
            let mut hits = circle(o, d, radius);
            hits.retain(|&t| (0.0..=top).contains(&along(t).z));
            let caps = [0.0, top].map(|z| (z - o.z) / d.z);
            hits.extend(
                caps.into_iter()
                    .filter(|&t| along(t).x.hypot(along(t).y) <= radius),
            );
            hits
        }
        SolidShape::Bore(bore) => {
            let mut leave = circle(o, d, f64::from(bore.radius)).split_off(1);
            leave.retain(|&t| (0.0..=f64::from(bore.length)).contains(&along(t).z));
            leave
        }
        SolidShape::SolidBox(block) => {
            let half = block.half.as_f64();
            let on_face = |&(t, axis): &(f64, usize)| {
                let (p, half): ([f64; 3], [f64; 3]) = (along(t).into(), half.into());
                (0..3).all(|k| k == axis || p[k].abs() <= half[k])
            };
            let faces = faces(o, d, half).into_iter();
            faces.filter(on_face).map(|(t, _)| t).collect()
        }
        SolidShape::Room(room) => {
            let half = room.half.as_f64();
            let walls = faces(o, d, half).into_iter().filter(|&(_, axis)| axis < 2);
            let leave = walls.map(|(t, _)| t).filter(|&t| t > 0.0);
            let leave = leave.fold(f64::INFINITY, f64::min);
            let open = along(leave).z.abs() > half.z;
            if open { vec![] } else { vec![leave] }
        }
        SolidShape::Ellipsoid(ball) => {
            let radii = ball.radii.as_f64();
            let scaled = |v: DVec3| vec3(v.x / radii.x, v.y / radii.y, v.z / radii.z);
            let (o, d) = (scaled(o), scaled(d));
            roots(d.dot(d), o.dot(d), o.dot(o) - 1.0)
        }
        SolidShape::Stone(stone) => {
            let planes = stone
                .planes
                .map(|(normal, offset)| (normal.as_f64(), f64::from(offset)));
            let hits = planes.map(|(normal, offset)| (offset - normal.dot(o)) / normal.dot(d));
            let inside = |&t: &f64| {
                planes
                    .iter()
                    .all(|(normal, offset)| normal.dot(along(t)) - offset <= 1e-9)
            };
            hits.into_iter().filter(inside).collect()
        }
        SolidShape::Ring(ring) => bend(ring, o, d).into_iter().collect(),
    };
    let ahead = hits.into_iter().filter(|&t| t > 0.0);
    ahead.fold(f64::INFINITY, f64::min)
}

/// Roots of a t² + 2 b t + c, the smaller one first.
fn roots(a: f64, b: f64, c: f64) -> Vec<f64> {
    let root = b * b - a * c;
    if root < 0.0 {
        return vec![];
    }
    vec![(-b - root.sqrt()) / a, (-b + root.sqrt()) / a]
}

fn circle(o: DVec3, d: DVec3, radius: f64) -> Vec<f64> {
    let (o, d) = (vec3(o.x, o.y, 0.0), vec3(d.x, d.y, 0.0));
    roots(d.dot(d), o.dot(d), o.dot(o) - radius * radius)
}

/// Where a ray crosses the planes of a box's faces, with the axis of each.
fn faces(o: DVec3, d: DVec3, half: DVec3) -> Vec<(f64, usize)> {
    let axes = [(o.x, d.x, half.x), (o.y, d.y, half.y), (o.z, d.z, half.z)];
    let sides = axes.into_iter().enumerate();
    let crossings = sides.flat_map(|(axis, (o, d, half))| [-half, half].map(|side| ((side - o) / d, axis)));
    crossings.collect()
}

/// First sign change of the distance along the ray, in steps of a part of the thickness, then bisected.
fn bend(ring: &Ring, o: DVec3, d: DVec3) -> Option<f64> {
    let (bend, tube) = (f64::from(ring.bend_radius), f64::from(ring.tube_radius));
    let [sin, cos] = ring.half_angle.map(f64::from);
    let reach = bend + tube;
    if o.cross(d).length() / d.length() > reach {
        return None;
    }
    let distance = |t: f64| {
        let p = o + d * t;
        let x = p.x.abs();
        let around = x.hypot(p.y);
        let nearest = if cos * x > sin * p.y {
            vec3(sin * bend, cos * bend, 0.0)
        } else {
            vec3(x / around * bend, p.y / around * bend, 0.0)
        };
        (vec3(x, p.y, p.z) - nearest).length() - tube
    };
    let middle = -o.dot(d) / d.dot(d);
    let start = (middle - 1.01 * reach / d.length()).max(0.0);
    let end = middle + reach / d.length();
    let step = 0.02 * tube / d.length();
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
        t += step.max(0.9 * distance(t) / d.length());
    }
    None
}
