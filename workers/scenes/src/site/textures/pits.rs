//! Scour pits: bowls in the ground, parts of spheres below z = 0.
//!
//! Outside the pits the ground is the plane z = 0. A ray through the mouth of a pit continues to its wall, and from
//! there into any overlapping pit. Intersections are exact, as with solids.

use imaging::vector::{Vec3, vec3};

use crate::site::lanes::{LANES, Lane3, store};
use crate::site::pose::up;

/// A bowl: a sphere below the plane of the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pit {
    /// Center of its mouth; z = 0.
    pub(crate) place: Vec3,
    /// Radius of its mouth, m.
    pub(crate) radius: f32,
    /// Height of the sphere's center above the ground, m; negative below it.
    lift: f32,
    ball: f32,
}

impl Pit {
    /// A bowl of this radius and depth, m; the depth must not exceed the radius.
    pub(crate) fn new(place: Vec3, radius: f32, depth: f32) -> Self {
        let depth = depth.min(radius);
        let ball = (radius * radius + depth * depth) / (2.0 * depth);
        Self {
            place: vec3(place.x, place.y, 0.0),
            radius,
            lift: ball - depth,
            ball,
        }
    }

    fn center(&self) -> Vec3 {
        self.place + up(self.lift)
    }

    fn is_over(&self, x: f32, y: f32) -> bool {
        let (x, y) = (x - self.place.x, y - self.place.y);
        x * x + y * y < self.radius * self.radius
    }

    /// Depth of the ground under a point of the plane; 0 outside the pit.
    pub(crate) fn depth(&self, x: f32, y: f32) -> f32 {
        let (x, y) = (x - self.place.x, y - self.place.y);
        let square = self.ball * self.ball - x * x - y * y;
        if self.is_over(self.place.x + x, self.place.y + y) {
            square.max(0.0).sqrt() - self.lift
        } else {
            0.0
        }
    }

    /// Where a ray leaves the sphere, in lengths of its direction.
    fn leave(&self, from: Vec3, direction: Vec3) -> f32 {
        let away = from - self.center();
        let square = direction.dot(direction);
        let along = away.dot(direction);
        let cross = away.cross(direction);
        let discriminant = self.ball * self.ball * square - cross.dot(cross);
        (discriminant.max(0.0).sqrt() - along) / square
    }

    fn holds(&self, point: Vec3) -> bool {
        // Exclude the surface itself: rays end there.
        let within = self.ball * (1.0 - 1e-5);
        let away = point - self.center();
        point.z <= 0.0 && away.dot(away) < within * within
    }
}

/// Continues a ray that meets the ground plane at `reach` lengths of its direction to the bottom of the pits.
pub(crate) fn sink(pits: &[Pit], from: Vec3, direction: Vec3, reach: f32) -> f32 {
    let mouth = from + direction * reach;
    let Some(first) = pits.iter().find(|pit| pit.is_over(mouth.x, mouth.y)) else {
        return reach;
    };
    let mut met = first.leave(from, direction).max(reach);
    // Each pit can pass the ray on to another at most once.
    for _ in pits {
        let position = from + direction * met;
        let Some(next) = pits.iter().find(|pit| pit.holds(position)) else {
            break;
        };
        met = next.leave(from, direction).max(met);
    }
    met
}

/// The deepest ground under a point.
pub(crate) fn depth(pits: &[Pit], x: f32, y: f32) -> f32 {
    pits.iter().map(|pit| pit.depth(x, y)).fold(0.0, f32::max)
}

/// The unit normal at a point of the ground.
pub(crate) fn normal(pits: &[Pit], point: Vec3) -> Vec3 {
    let deepest = pits
        .iter()
        .filter(|pit| pit.is_over(point.x, point.y))
        .max_by(|a, b| a.depth(point.x, point.y).total_cmp(&b.depth(point.x, point.y)));
    match deepest {
        Some(pit) => (pit.center() - point).normalized(),
        None => up(1.0),
    }
}

/// [`normal`] of a group of points.
pub(crate) fn tilt(pits: &[Pit], world: &Lane3, normals: &mut Lane3) {
    for i in 0..LANES {
        let point = vec3(world[0][i], world[1][i], world[2][i]);
        store(normals, i, normal(pits, point));
    }
}

/// Whether the ground blocks the segment between two of its points. Points in the same pit see each other.
pub(crate) fn is_between(pits: &[Pit], begin: Vec3, end: Vec3) -> bool {
    let (below, above) = if begin.z < end.z {
        (begin, end)
    } else {
        (end, begin)
    };
    if below.z >= 0.0 {
        return false;
    }
    let Some(pit) = pits.iter().find(|pit| pit.is_over(below.x, below.y)) else {
        return true;
    };
    if above.z <= 0.0 {
        return !pit.is_over(above.x, above.y);
    }
    let mouth = below + (above - below) * (below.z / (below.z - above.z));
    !pit.is_over(mouth.x, mouth.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pit() -> Pit {
        Pit::new(vec3(1.0, 2.0, 5.0), 1.5, 0.5)
    }

    #[test]
    fn a_ray_straight_down_meets_the_bottom_and_beside_it_the_plane() {
        let pits = [pit()];
        let down = vec3(0.0, 0.0, -1.0);
        assert!((sink(&pits, vec3(1.0, 2.0, 3.0), down, 3.0) - 3.5).abs() < 1e-5);
        assert_eq!(sink(&pits, vec3(4.0, 2.0, 3.0), down, 3.0), 3.0);
        assert!((pit().depth(1.0, 2.0) - 0.5).abs() < 1e-5 && pit().depth(2.49, 2.0) < 0.01);
        assert!((normal(&pits, vec3(1.0, 2.0, -0.5)) - up(1.0)).length() < 1e-5);
        assert!(normal(&pits, vec3(2.0, 2.0, -0.2)).x < -0.1);
    }

    #[test]
    fn rays_end_on_the_deepest_ground_of_pits_that_overlap() {
        let pits = [pit(), Pit::new(vec3(2.2, 2.0, 0.0), 1.2, 0.6)];
        let mut deep = 0;
        for i in 0..400 {
            let start = vec3(-2.0, 2.0 + 0.002 * i as f32, 2.0);
            let target = vec3(0.01 * i as f32, 2.0, 0.0);
            let way = target - start;
            let met = start + way * sink(&pits, start, way, 1.0);
            let wanted = -depth(&pits, met.x, met.y);
            assert!((met.z - wanted).abs() < 2e-3, "{i}: {met:?} {wanted}");
            deep += usize::from(met.z < -0.3);
        }
        assert!(deep > 20, "{deep}");
    }

    #[test]
    fn what_is_in_a_pit_sees_out_through_its_mouth_alone() {
        let pits = [pit()];
        let bottom = vec3(1.0, 2.0, -0.49);
        assert!(!is_between(&pits, bottom, vec3(1.0, 2.0, 3.0)));
        assert!(!is_between(&pits, vec3(1.5, 2.0, -0.4), bottom));
        assert!(is_between(&pits, bottom, vec3(9.0, 2.0, 0.5)));
        assert!(is_between(&pits, vec3(7.0, 2.0, -0.1), vec3(7.0, 2.0, 2.0)));
        assert!(!is_between(&pits, vec3(7.0, 2.0, 0.1), vec3(7.0, 2.0, 2.0)));
    }
}
