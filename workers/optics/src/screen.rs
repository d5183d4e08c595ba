//! A range image as a scene: a height field over the picture, for scenes of which nothing else is known.
//!
//! It must fail where the picture shows nothing: surfaces beside it or behind others do not exist, undersides are guesses, and a thing is
//! as thick as 5 cm and 5 % of its range. A hole is never met.

use imaging::Plane;
use imaging::geometry::Intrinsics;
use imaging::rays::{Hit, Rays};
use imaging::vector::{DVec3, Vector};

use crate::lamp::normals_of;
use crate::range::is_hole;

/// Samples of a cell of which one is farther by more than this factor lie on both sides of an edge.
const EDGE: f64 = 1.25;
/// Nothing is seen nearer to the plane of the camera than this, m.
const NEAR_M: f64 = 0.01;
/// No ray is followed farther, m.
const FAR_M: f64 = 1e4;
/// Steps along a ray for each pixel that it passes.
const STEPS: f64 = 2.0;
const BISECTIONS: usize = 8;
/// A surface is met where a ray is behind it by more than this share of its depth.
const ROUNDING: f64 = 1e-6;

/// A range image with its camera.
pub struct Screen {
    camera: Intrinsics,
    /// 1/z of each pixel, which is linear over a plane; NaN at holes.
    inverse: Plane<f64>,
    normals: [Plane<f32>; 3],
}

/// A piece of a ray as it lies in the picture.
struct Trail {
    origin: DVec3,
    direction: DVec3,
    /// Distances along the ray at which it begins and ends.
    ends: [f64; 2],
    /// Columns and rows there.
    places: [[f64; 2]; 2],
    /// 1/z there.
    inverse: [f64; 2],
}

impl Screen {
    /// The scene of a range image in meters along the ray.
    #[must_use]
    pub fn new(range: &Plane<f32>, camera: Intrinsics) -> Self {
        let inverse = Plane::from_fn(range.width(), range.height(), |x, y| {
            let z = range.pixel(x, y);
            let stretch = camera.ray(x as f64, y as f64).length();
            if is_hole(z) {
                f64::NAN
            } else {
                stretch / f64::from(z)
            }
        });
        Self {
            camera,
            inverse,
            normals: normals_of(range, &camera),
        }
    }

    /// 1/z at a place of the picture: between four samples, or the nearest at edges and holes.
    fn at(&self, [x, y]: [f64; 2]) -> Option<f64> {
        let (width, height) = self.inverse.size();
        let inside = |v: f64, count: usize| v > -0.5 && v < count as f64 - 0.5;
        if !inside(x, width) || !inside(y, height) {
            return None;
        }
        let cell = |v: f64, count: usize| (v.max(0.0) as usize).min(count.saturating_sub(2));
        let (left, top) = (cell(x, width), cell(y, height));
        let (right, bottom) = ((left + 1).min(width - 1), (top + 1).min(height - 1));
        let corners = [(left, top), (right, top), (left, bottom), (right, bottom)];
        let corners = corners.map(|(x, y)| self.inverse.pixel(x, y));
        let (least, most) = corners
            .iter()
            .fold((f64::INFINITY, 0.0f64), |(a, b), v| (a.min(*v), b.max(*v)));
        if corners.iter().any(|v| v.is_nan()) || most > EDGE * least {
            let (x, y) = self.nearest([x, y]);
            return Some(self.inverse.pixel(x, y)).filter(|v| !v.is_nan());
        }
        let (u, v) = (x - left as f64, y - top as f64);
        let [a, b, c, d] = corners;
        Some((1.0 - v) * ((1.0 - u) * a + u * b) + v * ((1.0 - u) * c + u * d))
    }

    fn nearest(&self, [x, y]: [f64; 2]) -> (usize, usize) {
        let (width, height) = self.inverse.size();
        let index = |v: f64, count: usize| (v.round().max(0.0) as usize).min(count - 1);
        (index(x, width), index(y, height))
    }

    /// The part of a ray that the picture shows.
    fn trail(&self, origin: DVec3, direction: DVec3, from: f64, to: f64) -> Option<Trail> {
        let (mut from, mut to) = (from, to.min(FAR_M));
        let reaches = (NEAR_M - origin.z) / direction.z;
        if direction.z > 0.0 {
            from = from.max(reaches);
        } else if direction.z < 0.0 {
            to = to.min(reaches);
        } else if origin.z < NEAR_M {
            return None;
        }
        if from.partial_cmp(&to) != Some(std::cmp::Ordering::Less) {
            return None;
        }
        let at = |distance: f64| origin + direction * distance;
        let (first, last) = (at(from), at(to));
        let place = |p: DVec3| {
            [
                self.camera.focal_px * p.x / p.z + self.camera.cx,
                self.camera.focal_px * p.y / p.z + self.camera.cy,
            ]
        };
        Some(Trail {
            origin,
            direction,
            ends: [from, to],
            places: [place(first), place(last)],
            inverse: [1.0 / first.z, 1.0 / last.z],
        })
    }

    /// By how much of its depth the ray is behind the surface at a share of its trail; none where nothing is shown.
    fn behind(&self, trail: &Trail, share: f64) -> Option<f64> {
        let surface = self.at(trail.place(share))?;
        Some(surface / trail.inverse_at(share) - 1.0)
    }

    /// The share of a trail at which it meets a surface.
    fn meet(&self, trail: &Trail) -> Option<f64> {
        let [enter, leave] = trail.within(self.inverse.size())?;
        let [first, last] = trail.places;
        let pixels = (last[0] - first[0]).hypot(last[1] - first[1]) * (leave - enter);
        let steps = (STEPS * pixels).ceil().clamp(1.0, 1e6) as usize;
        let mut before = enter;
        for step in 0..=steps {
            let share = enter + (leave - enter) * step as f64 / steps as f64;
            if let Some(depth) = self.behind(trail, share) {
                let range = trail.range(share);
                // As far behind it as it is thick, in range: both grow alike along one line of sight.
                let beyond = range * depth / (1.0 + depth);
                if depth > ROUNDING && beyond <= 0.05 + 0.05 * (range - beyond) {
                    return Some(self.refine(trail, before, share));
                }
            }
            before = share;
        }
        None
    }

    /// Where between a place before the surface and one behind it the ray meets it.
    fn refine(&self, trail: &Trail, mut before: f64, mut behind: f64) -> f64 {
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (before + behind);
            match self.behind(trail, middle) {
                Some(depth) if depth > ROUNDING => behind = middle,
                _ => before = middle,
            }
        }
        behind
    }

    fn hit_at(&self, trail: &Trail, distance: f64) -> Hit {
        let share = trail.share(distance);
        let (x, y) = self.nearest(trail.place(share));
        let normal = DVec3::from([0, 1, 2].map(|i| f64::from(self.normals[i].pixel(x, y))));
        let facing = if normal.dot(trail.direction) > 0.0 {
            -normal
        } else {
            normal
        };
        Hit {
            distance,
            normal: facing.into(),
            object: 0,
        }
    }
}

impl Trail {
    fn place(&self, share: f64) -> [f64; 2] {
        [0, 1].map(|i| self.places[0][i] + share * (self.places[1][i] - self.places[0][i]))
    }

    fn inverse_at(&self, share: f64) -> f64 {
        self.inverse[0] + share * (self.inverse[1] - self.inverse[0])
    }

    /// Distance along the ray at a share of its picture.
    fn distance(&self, share: f64) -> f64 {
        let part = share * self.inverse[1] / self.inverse_at(share);
        self.ends[0] + part * (self.ends[1] - self.ends[0])
    }

    /// The inverse of [`Trail::distance`].
    fn share(&self, distance: f64) -> f64 {
        let part = (distance - self.ends[0]) / (self.ends[1] - self.ends[0]);
        part * self.inverse[0] / (part * self.inverse[0] + (1.0 - part) * self.inverse[1])
    }

    /// Distance from the camera at a share.
    fn range(&self, share: f64) -> f64 {
        (self.origin + self.direction * self.distance(share)).length()
    }

    /// The shares between which it lies in a frame.
    fn within(&self, (width, height): (usize, usize)) -> Option<[f64; 2]> {
        let mut shares = [0.0f64, 1.0];
        for (i, count) in [width, height].into_iter().enumerate() {
            let (from, step) = (self.places[0][i], self.places[1][i] - self.places[0][i]);
            let ends = [-0.5 - from, count as f64 - 0.5 - from];
            if step == 0.0 {
                if ends[0] > 0.0 || ends[1] < 0.0 {
                    return None;
                }
                continue;
            }
            let (a, b) = (ends[0] / step, ends[1] / step);
            shares = [shares[0].max(a.min(b)), shares[1].min(a.max(b))];
        }
        (shares[0] <= shares[1]).then_some(shares)
    }
}

impl Rays for Screen {
    fn hit(&self, origin: [f64; 3], direction: [f64; 3], from: f64, to: f64) -> Option<Hit> {
        let (origin, direction) = (Vector::from(origin), Vector::from(direction));
        if origin == Vector::from([0.0; 3]) {
            // A line of sight is one place of the picture.
            let trail = self.trail(origin, direction, NEAR_M / direction.z, f64::INFINITY)?;
            let distance = 1.0 / (self.at(trail.places[0])? * direction.z);
            return (distance >= from && distance <= to).then(|| self.hit_at(&trail, distance));
        }
        let trail = self.trail(origin, direction, from, to)?;
        let distance = trail.distance(self.meet(&trail)?);
        Some(self.hit_at(&trail, distance))
    }

    fn occluded(&self, origin: [f64; 3], direction: [f64; 3], from: f64, to: f64) -> bool {
        let trail = self.trail(origin.into(), direction.into(), from, to);
        trail.is_some_and(|trail| self.meet(&trail).is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: usize = 65;

    /// A slanted wall, and before it a square at 2 m.
    fn screen() -> (Screen, Intrinsics) {
        let camera = Intrinsics::centered(60.0, SIZE, SIZE);
        let range = Plane::from_fn(SIZE, SIZE, |x, y| {
            let ray = camera.ray(x as f64, y as f64);
            let square = (24..=40).contains(&x) && (24..=40).contains(&y);
            let z = if square { 2.0 } else { 4.0 / (1.0 - 0.3 * ray.x) };
            (z * ray.length()) as f32
        });
        (Screen::new(&range, camera), camera)
    }

    #[test]
    fn the_camera_meets_what_it_sees() {
        let (screen, camera) = screen();
        for (x, y) in [(5.0, 7.5), (50.3, 60.0), (12.2, 30.0)] {
            let ray = camera.ray(x, y).normalized();
            let hit = screen.hit([0.0; 3], ray.into(), 0.0, 100.0).unwrap();
            let expected = 4.0 / (ray.z - 0.3 * ray.x);
            assert!((hit.distance / expected - 1.0).abs() < 1e-5, "{hit:?}");
            assert!(DVec3::from(hit.normal).dot(ray) < 0.0);
        }
        let middle = screen.hit([0.0; 3], [0.0, 0.0, 1.0], 0.0, 100.0).unwrap();
        assert!((middle.distance - 2.0).abs() < 1e-6);
        assert_eq!(screen.hit([0.0; 3], [0.9, 0.0, 0.1], 0.0, 100.0), None);
    }

    #[test]
    fn a_lamp_beside_the_camera_sees_the_wall_but_not_behind_the_square() {
        let (screen, camera) = screen();
        let lamp = DVec3::from([-1.0, 0.0, 0.1]);
        let lit = |x: f64, y: f64| {
            let ray = camera.ray(x, y).normalized();
            let place = ray * (4.0 / (ray.z - 0.3 * ray.x));
            let hit = screen.hit([0.0; 3], ray.into(), 0.0, 100.0).unwrap();
            let start = imaging::rays::leaving(place.into(), hit.normal);
            let away = lamp + -DVec3::from(start.origin);
            let toward = away.normalized();
            !screen.occluded(start.origin, toward.into(), start.from, away.length())
        };
        // Beside the square on the lamp's side, above it, and in its shadow on the other side.
        assert!(lit(10.0, 32.0) && lit(32.0, 4.0) && lit(60.0, 4.0));
        assert!(!lit(44.0, 32.0));
    }
}
