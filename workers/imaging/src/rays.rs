//! Ray queries of scenes. Points and directions are in camera axes (right, down, ahead; the camera at the origin), in
//! meters.

use crate::vector::dot;

/// Offset from a surface relative to the distance from the camera; also the minimum in meters below 1 m.
pub const OFFSET: f64 = 1e-5;

/// Nearest intersection of a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance from the origin, m.
    pub distance: f64,
    /// Unit normal of the surface, facing the ray: its dot product with the direction is at most 0.
    pub normal: [f64; 3],
    /// Object number of the scene; equal numbers are the same object.
    pub object: u32,
}

/// An axis-aligned box between its lowest and its highest corner, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cuboid {
    /// Lower corner.
    pub low: [f64; 3],
    /// Upper corner.
    pub high: [f64; 3],
}

impl Cuboid {
    /// The box around a point, `meters` away on every side.
    #[must_use]
    pub fn centered(place: [f64; 3], meters: f64) -> Self {
        Self {
            low: place.map(|v| v - meters),
            high: place.map(|v| v + meters),
        }
    }

    /// Its eight corners.
    #[must_use]
    pub fn corners(&self) -> [[f64; 3]; 8] {
        std::array::from_fn(|corner| [0, 1, 2].map(|axis| [self.low, self.high][corner >> axis & 1][axis]))
    }

    /// The distances from a point to its nearest and to its farthest point.
    #[must_use]
    pub fn distances(&self, place: [f64; 3]) -> [f64; 2] {
        let sides = [0, 1, 2].map(|i| [self.low[i] - place[i], place[i] - self.high[i]]);
        let nearest = sides.map(|[before, behind]| before.max(behind).max(0.0));
        let farthest = sides.map(|[before, behind]| before.abs().max(behind.abs()));
        [nearest, farthest].map(|way| dot(way, way).sqrt())
    }
}

/// Ray queries of a scene. `direction` is a unit vector; surfaces nearer than `from` or farther than `to` meters are
/// ignored.
pub trait Rays {
    /// The nearest intersection.
    fn hit(&self, origin: [f64; 3], direction: [f64; 3], from: f64, to: f64) -> Option<Hit>;

    /// Whether anything intersects the segment.
    fn occluded(&self, origin: [f64; 3], direction: [f64; 3], from: f64, to: f64) -> bool {
        self.hit(origin, direction, from, to).is_some()
    }

    /// Whether anything may block a segment from one box to the other. Conservative: `false` guarantees that all
    /// segments are clear.
    fn may_occlude(&self, _from: &Cuboid, _to: &Cuboid) -> bool {
        true
    }

    /// A lower bound of the distance from a point to any surface, m.
    fn clearance(&self, _place: [f64; 3]) -> f64 {
        0.0
    }

    /// Sets for each shadow ray whether it is clear; `clear` must have the length of the list. Surfaces within
    /// [`offset`] of the origin are ignored. Scenes that test packets of rays override this.
    fn trace_shadow_rays(&self, rays: &ShadowRays, clear: &mut [bool]) {
        for (i, clear) in clear.iter_mut().enumerate() {
            let [origin, end] =
                [&rays.from, &rays.to].map(|ends| ends.each_ref().map(|axis| f64::from(axis[i])));
            let way = [0, 1, 2].map(|axis| end[axis] - origin[axis]);
            let (meters, from) = (dot(way, way).sqrt(), offset(origin));
            *clear = meters <= from || !self.occluded(origin, way.map(|v| v / meters), from, meters);
        }
    }
}

/// Segments between two points each, in meters, one array per axis. Neighbors in the list should be close in space:
/// coherent packets are faster.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ShadowRays {
    /// Origins, offset from their surface.
    pub from: [Vec<f32>; 3],
    /// Ends.
    pub to: [Vec<f32>; 3],
}

impl ShadowRays {
    /// Number of segments.
    #[must_use]
    pub fn len(&self) -> usize {
        self.from[0].len()
    }

    /// Whether it is empty.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Removes all segments.
    pub fn clear(&mut self) {
        self.from.iter_mut().chain(&mut self.to).for_each(Vec::clear);
    }

    /// Adds a segment.
    pub fn push(&mut self, from: [f32; 3], to: [f32; 3]) {
        let axes = self.from.iter_mut().chain(&mut self.to);
        axes.zip(from.into_iter().chain(to))
            .for_each(|(axis, value)| axis.push(value));
    }
}

/// RayStart of a ray that leaves a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayStart {
    /// The surface point, offset along the normal.
    pub origin: [f64; 3],
    /// Surfaces nearer than this are ignored, m.
    pub from: f64,
}

/// Offset of a ray from the surface that it leaves at a point: `1e-5 max(1, |place|)` m. Rounding is proportional to
/// the distance from the camera, and a ray from the surface itself would intersect it again.
#[must_use]
pub fn offset(place: [f64; 3]) -> f64 {
    OFFSET * dot(place, place).sqrt().max(1.0)
}

/// The start of a ray that leaves a surface with this unit normal: [`offset`] along the normal, ignoring surfaces
/// within the same distance.
#[must_use]
pub fn leaving(place: [f64; 3], normal: [f64; 3]) -> RayStart {
    let offset = offset(place);
    RayStart {
        origin: [0, 1, 2].map(|i| place[i] + offset * normal[i]),
        from: offset,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Everything with z above 0 is solid.
    struct Ground;

    impl Rays for Ground {
        fn hit(&self, origin: [f64; 3], direction: [f64; 3], from: f64, to: f64) -> Option<Hit> {
            let distance = -origin[2] / direction[2];
            (distance >= from && distance <= to).then_some(Hit {
                distance,
                normal: [0.0, 0.0, -direction[2].signum()],
                object: 0,
            })
        }
    }

    #[test]
    fn a_ray_that_leaves_a_surface_does_not_meet_it_again() {
        for meters in [0.0, 0.5, 3.0, 400.0] {
            // On the ground apart from f32 rounding, to either side.
            for lost in [-6e-8, 6e-8] {
                let place = [meters, -0.2, lost * f64::max(meters, 1.0)];
                let RayStart { origin, from } = leaving(place, [0.0, 0.0, -1.0]);
                for slope in [1.0f64, 1e-3] {
                    let direction = [(1.0 - slope * slope).sqrt(), 0.0, -slope];
                    assert!(!Ground.occluded(origin, direction, from, 1e3), "{meters} {lost}");
                }
                assert!(Ground.occluded(origin, [0.0, 0.0, 1.0], 0.0, 1.0));
            }
        }
    }

    #[test]
    fn the_distances_of_a_box_are_those_of_its_nearest_and_farthest_points() {
        let cuboid = Cuboid {
            low: [1.0, -1.0, 2.0],
            high: [2.0, 1.0, 4.0],
        };
        for place in [[0.0; 3], [1.5, 0.5, 3.0], [3.0, 5.0, -1.0]] {
            let away = |at: [f64; 3]| {
                let way = [0, 1, 2].map(|i| at[i] - place[i]);
                dot(way, way).sqrt()
            };
            let clamped = [0, 1, 2].map(|i| f64::clamp(place[i], cuboid.low[i], cuboid.high[i]));
            let farthest = cuboid.corners().map(away).into_iter().fold(0.0, f64::max);
            assert_eq!(cuboid.distances(place), [away(clamped), farthest]);
        }
        assert_eq!(Cuboid::centered([1.0; 3], 1.0).distances([1.0; 3])[0], 0.0);
    }

    #[test]
    fn ways_are_clear_that_no_ray_finds_anything_on() {
        let mut ways = ShadowRays::default();
        ways.push([0.0, 0.0, -1.0], [5.0, 0.0, -1e-3]);
        ways.push([0.0, 0.0, -1.0], [5.0, 0.0, 1e-3]);
        ways.push([0.0, 0.0, -1e-6], [0.0, 0.0, 1e-6]);
        let mut clear = [false; 3];
        Ground.trace_shadow_rays(&ways, &mut clear);
        assert_eq!((clear, ways.len()), ([true, false, true], 3));
        ways.clear();
        assert!(ways.is_empty());
    }
}
