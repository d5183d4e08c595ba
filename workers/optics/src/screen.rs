//! A range image as a scene: a height field over the picture, for scenes without geometry.
//!
//! It is wrong about surfaces outside the picture: those outside the frame or behind others do not exist, undersides are guesses,
//! and objects have a thickness of 5 cm and 5 % of their range. A hole is never hit.

mod extent;
#[cfg(test)]
mod tests;
mod trail;

use imaging::Plane;
use imaging::geometry::Intrinsics;
use imaging::rays::{Hit, Rays};
use imaging::vector::{DVec3, Vector};

use crate::lamp::normals_of;
use crate::range::is_hole;
use extent::{Extent, Square};
use trail::Trail;

/// Samples of a cell whose ranges differ by more than this factor are on both sides of an edge.
const EDGE: f64 = 1.25;
/// Near limit from the plane of the camera, m.
const NEAR_M: f64 = 0.01;
/// Rays end here, m.
const FAR_M: f64 = 1e4;
/// Steps along a ray for each pixel that it passes.
const STEPS: f64 = 2.0;
const BISECTIONS: usize = 8;
/// A ray intersects a surface if it is behind it by more than this share of its depth.
const ROUNDING: f64 = 1e-6;
/// Thickness of a surface: meters, and a share of its range.
const THICK_M: f64 = 0.05;
const THICK: f64 = 0.05;
/// Between its samples a surface may be nearer than at them by this share of its range, with its thickness.
const BESIDE: f64 = THICK + EDGE - 1.0;
/// A ray must be behind all surfaces of a square by this share more: points along a ray are known to 1e-8 of their depth.
const SURELY: f64 = 1e-6;

/// A range image with its camera.
pub struct Screen {
    camera: Intrinsics,
    /// 1/z of each pixel, which is linear over a plane; NaN at holes.
    inverse: Plane<f64>,
    normals: [Plane<f32>; 3],
    /// Depth bounds for skipping empty squares; `None` in the reference.
    extent: Option<Extent>,
}

impl Screen {
    /// The scene of a range image in meters along the ray. It has the same intersections as [`Screen::reference`].
    #[must_use]
    pub fn new(range: &Plane<f32>, camera: Intrinsics) -> Self {
        let plain = Self::reference(range, camera);
        let extent = Some(Extent::new(&plain.inverse));
        Self { extent, ..plain }
    }

    /// The same scene, testing every step of every ray.
    #[must_use]
    pub fn reference(range: &Plane<f32>, camera: Intrinsics) -> Self {
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
            extent: None,
        }
    }

    /// 1/z at a point of the picture: interpolated between four samples, or the nearest at edges and holes.
    fn at(&self, [x, y]: [f64; 2]) -> Option<f64> {
        let (width, height) = self.inverse.size();
        let inside = |v: f64, count: usize| v > -0.5 && v < count as f64 - 0.5;
        if !inside(x, width) || !inside(y, height) {
            return None;
        }
        let (left, top) = self.cell([x, y]);
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

    /// The upper left one of the four samples around a point of the picture.
    fn cell(&self, [x, y]: [f64; 2]) -> (usize, usize) {
        let (width, height) = self.inverse.size();
        let first = |v: f64, count: usize| (v.max(0.0) as usize).min(count.saturating_sub(2));
        (first(x, width), first(y, height))
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

    /// Depth of the ray behind the surface at a share of its trail, relative to its depth; `None` without surface.
    fn behind(&self, trail: &Trail, share: f64) -> Option<f64> {
        let surface = self.at(trail.place(share))?;
        Some(surface / trail.inverse_at(share) - 1.0)
    }

    /// The share of a trail at its intersection with a surface: within the first of equal steps that ends behind one.
    fn meet(&self, trail: &Trail) -> Option<f64> {
        let march = March::new(trail, self.inverse.size())?;
        let step = self.first_behind(&march)?;
        Some(self.refine(trail, march.share(step.saturating_sub(1)), march.share(step)))
    }

    /// The first step of a march behind a surface, within its thickness.
    fn first_behind(&self, march: &March<'_>) -> Option<usize> {
        // Levels from 1 on skip squares; level 0 tests the steps themselves.
        let lowest = self.extent.as_ref().map_or(0, |extent| extent.top().min(1));
        let (mut step, mut level) = (0, 0);
        while step <= march.steps {
            if let Some(extent) = self.extent.as_ref().filter(|_| level > 0) {
                let square = Square::around(self.cell(march.trail.place(march.share(step))), level);
                if let Some(last) = self.passes(march, extent.of(square), (square, step)) {
                    (step, level) = (last + 1, (level + 1).min(extent.top()));
                } else {
                    level -= 1;
                }
                continue;
            }
            if self.is_met(march.trail, march.share(step)) {
                return Some(step);
            }
            step += 1;
            level = lowest;
        }
        None
    }

    /// The last step up to which a march, from this step on, stays over a square of the picture, if it surely has no intersection
    /// there. Points and depths are monotonic from step to step, including their rounding: bounds at both ends hold between them.
    fn passes(
        &self,
        march: &March<'_>,
        [least, most]: [f64; 2],
        (square, step): (Square, usize),
    ) -> Option<usize> {
        let trail = march.trail;
        let last = march.leaves(square).clamp(step, march.steps);
        let end = march.share(last);
        if Square::around(self.cell(trail.place(end)), square.level) != square {
            return None;
        }
        let (a, b) = (trail.inverse_at(march.share(step)), trail.inverse_at(end));
        let (far, near) = (a.min(b), a.max(b));
        let is_before = most <= far;
        // 1/near − (1 + THICK)/least > THICK_M, each side of it rounded against it.
        let is_behind = least > 0.0
            && (1.0 - SURELY) * (least - (1.0 + THICK) * near) > (1.0 + SURELY) * THICK_M * near * least;
        (is_before || is_behind).then_some(last)
    }

    /// Whether a point of a trail is behind a surface, within its thickness.
    fn is_met(&self, trail: &Trail, share: f64) -> bool {
        self.behind(trail, share).is_some_and(|depth| {
            let range = trail.range(share);
            // The thickness behind it, in range: both grow equally along one line of sight.
            let beyond = range * depth / (1.0 + depth);
            depth > ROUNDING && beyond <= THICK_M + THICK * (range - beyond)
        })
    }

    /// The intersection with a surface, between a point before it and one behind it.
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

    /// Lower bound of the distance from a place to the surface at a pixel; NaN at holes.
    fn distance_to(&self, (x, y): (usize, usize), place: DVec3) -> f64 {
        let ray = DVec3::from(<[f64; 3]>::from(self.camera.ray(x as f64, y as f64)));
        let surface = ray * (1.0 / self.inverse.pixel(x, y));
        (surface - place).length() - THICK_M - BESIDE * surface.length()
    }

    /// Lower bound of [`Screen::distance_to`] of all samples of a square: by a box around its surfaces.
    fn least_distance(&self, square: Square, [least, most]: [f64; 2], place: DVec3) -> f64 {
        if least > most {
            return f64::INFINITY;
        }
        let depths = [1.0 / most, 1.0 / least.max(0.0)];
        let centers = [self.camera.cx, self.camera.cy];
        let place = <[f64; 3]>::from(place);
        let (mut apart, mut farthest) = (0.0, 0.0);
        for axis in 0..3 {
            let ends = match centers.get(axis) {
                Some(center) => square
                    .edges(axis)
                    .map(|edge| (edge - center) / self.camera.focal_px),
                None => [1.0; 2],
            };
            let corners = ends.map(|end| depths.map(|depth| end * depth));
            let (low, high) = corners
                .as_flattened()
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                    (low.min(*v), high.max(*v))
                });
            let outside = (low - place[axis]).max(place[axis] - high).max(0.0);
            apart += outside * outside;
            farthest += low.abs().max(high.abs()).powi(2);
        }
        (1.0 - SURELY) * apart.sqrt() - THICK_M - (1.0 + SURELY) * BESIDE * farthest.sqrt()
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

/// A trail in equal steps over the picture.
struct March<'a> {
    trail: &'a Trail,
    /// Shares at its entry into the picture and its exit.
    enter: f64,
    leave: f64,
    steps: usize,
    /// The share of a step, steps for each share, and shares for each column and row.
    pace: f64,
    frequency: f64,
    slowness: [f64; 2],
}

impl<'a> March<'a> {
    fn new(trail: &'a Trail, size: (usize, usize)) -> Option<Self> {
        let [enter, leave] = trail.within(size)?;
        let [first, last] = trail.places;
        let [columns, rows] = [0, 1].map(|axis| last[axis] - first[axis]);
        let pixels = (columns * columns + rows * rows).sqrt() * (leave - enter);
        let steps = (STEPS * pixels).ceil().clamp(1.0, 1e6) as usize;
        Some(Self {
            trail,
            enter,
            leave,
            steps,
            pace: (leave - enter) / steps as f64,
            frequency: steps as f64 / (leave - enter),
            slowness: [columns, rows].map(|pixels| 1.0 / pixels),
        })
    }

    fn share(&self, step: usize) -> f64 {
        self.enter + self.pace * step as f64
    }

    /// About the last step over a square; a step too early rather than too late.
    fn leaves(&self, square: Square) -> usize {
        let share = (0..2).fold(self.leave, |share, axis| {
            let slowness = self.slowness[axis];
            let [low, high] = square.edges(axis);
            let edge = if slowness > 0.0 { high } else { low };
            // Along an axis without movement this is infinite or not a number, and never the minimum.
            share.min((edge - self.trail.places[0][axis]) * slowness)
        });
        let steps = (share - self.enter) * self.frequency;
        (steps - 1e-6).max(0.0) as usize
    }
}

impl Rays for Screen {
    fn hit(&self, origin: [f64; 3], direction: [f64; 3], from: f64, to: f64) -> Option<Hit> {
        let (origin, direction) = (Vector::from(origin), Vector::from(direction));
        if origin == Vector::from([0.0; 3]) {
            // A line of sight is one point of the picture.
            let trail = self.trail(origin, direction, NEAR_M / direction.z, f64::INFINITY)?;
            let distance = 1.0 / (self.at(trail.places[0])? * direction.z);
            return (distance >= from && distance <= to).then(|| self.hit_at(&trail, distance));
        }
        let trail = self.trail(origin, direction, from, to)?;
        let distance = trail.distance(self.meet(&trail)?);
        Some(self.hit_at(&trail, distance))
    }

    fn clearance(&self, place: [f64; 3]) -> f64 {
        let place = Vector::from(place);
        let (width, height) = self.inverse.size();
        let Some(extent) = &self.extent else {
            let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            let nearest = pixels.map(|pixel| self.distance_to(pixel, place));
            return nearest.fold(f64::INFINITY, f64::min).max(0.0);
        };
        let (mut nearest, mut open) = (f64::INFINITY, vec![extent.whole()]);
        while let Some(square) = open.pop() {
            if self.least_distance(square, extent.of(square), place) >= nearest {
                continue;
            }
            match extent.parts(square) {
                Some(parts) => open.extend(parts),
                None => {
                    let samples = square
                        .samples((width, height))
                        .map(|pixel| self.distance_to(pixel, place));
                    nearest = samples.fold(nearest, f64::min);
                }
            }
        }
        nearest.max(0.0)
    }

    fn occluded(&self, origin: [f64; 3], direction: [f64; 3], from: f64, to: f64) -> bool {
        let trail = self.trail(origin.into(), direction.into(), from, to);
        let Some(trail) = trail else { return false };
        let march = March::new(&trail, self.inverse.size());
        march.is_some_and(|march| self.first_behind(&march).is_some())
    }
}
