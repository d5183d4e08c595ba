//! What a picture shows, in boxes.

use imaging::Plane;
use imaging::geometry::Intrinsics;
use imaging::rays::Cuboid;
use imaging::vector::dot;

use crate::range::is_hole;

/// Columns and rows of a part of the picture.
const PART_PX: usize = 32;
/// Water is looked through up to here where nothing ends it, m.
const FAR_M: f64 = 1e3;
/// Depths between which water lies, m, and by how much each exceeds the one before it.
const FIRST_M: f64 = 0.25;
const GROWTH: f64 = 1.5;

/// Places of a part of the picture.
pub(super) struct View {
    pub(super) places: Cuboid,
    /// Pixels that a meter across the line of sight spans at most.
    pub(super) px_per_m: f64,
}

/// The parts of a picture.
pub(super) struct Outlook {
    parts: Vec<Part>,
    focal_px: f64,
}

struct Part {
    /// x/z and y/z of its places.
    low: [f64; 2],
    high: [f64; 2],
    /// The least and the greatest range of its surfaces; none in a part of holes.
    range_m: Option<[f64; 2]>,
    /// Whether any pixel of it has no end.
    is_open: bool,
}

impl Outlook {
    pub(super) fn new(range: &Plane<f32>, camera: &Intrinsics) -> Self {
        let (width, height) = range.size();
        let corners = (0..height).step_by(PART_PX);
        let corners = corners.flat_map(|y| (0..width).step_by(PART_PX).map(move |x| [x, y]));
        Self {
            parts: corners.map(|corner| Part::new(range, camera, corner)).collect(),
            focal_px: camera.focal_px,
        }
    }

    /// The surfaces that it shows.
    pub(super) fn surfaces(&self) -> impl Iterator<Item = View> {
        self.parts.iter().filter_map(|part| {
            let [nearest, farthest] = part.range_m?;
            let [least, most] = part.stretch();
            Some(View {
                places: part.between([nearest / most, farthest / least]),
                px_per_m: self.focal_px * most * most / nearest,
            })
        })
    }

    /// The water before them, and that without an end.
    pub(super) fn water(&self) -> impl Iterator<Item = View> {
        self.parts.iter().flat_map(|part| {
            let end = match part.range_m {
                Some([_, farthest]) if !part.is_open => farthest / part.stretch()[0],
                _ => FAR_M,
            };
            let depths = std::iter::successors(Some(FIRST_M), |depth| Some(GROWTH * depth));
            let begins = std::iter::once(0.0)
                .chain(depths)
                .take_while(move |depth| *depth < end);
            begins.map(move |begin| View {
                places: part.between([begin, (GROWTH * begin).max(FIRST_M).min(end)]),
                px_per_m: f64::INFINITY,
            })
        })
    }
}

impl Part {
    fn new(range: &Plane<f32>, camera: &Intrinsics, [left, top]: [usize; 2]) -> Self {
        let (width, height) = range.size();
        let (right, bottom) = ((left + PART_PX).min(width), (top + PART_PX).min(height));
        let (mut nearest, mut farthest, mut is_open) = (f32::INFINITY, 0.0f32, false);
        for y in top..bottom {
            for &z in &range.row(y)[left..right] {
                if is_hole(z) {
                    is_open = true;
                } else {
                    (nearest, farthest) = (nearest.min(z), farthest.max(z));
                }
            }
        }
        let place = |x: usize, y: usize| <[f64; 3]>::from(camera.ray(x as f64, y as f64));
        let ([x, y, _], [x_end, y_end, _]) = (place(left, top), place(right - 1, bottom - 1));
        Self {
            low: [x, y],
            high: [x_end, y_end],
            range_m: (farthest > 0.0).then(|| [nearest, farthest].map(f64::from)),
            is_open,
        }
    }

    /// The least and the greatest range over depth.
    fn stretch(&self) -> [f64; 2] {
        let near = [0, 1].map(|i| 0.0f64.clamp(self.low[i], self.high[i]));
        let far = [0, 1].map(|i| self.low[i].abs().max(self.high[i].abs()));
        [near, far].map(|[x, y]| dot([x, y, 1.0], [x, y, 1.0]).sqrt())
    }

    /// What it shows between two depths.
    fn between(&self, [near, far]: [f64; 2]) -> Cuboid {
        let ([left, top], [right, bottom]) = (self.low, self.high);
        let (least, most) = (
            |slope: f64| (slope * near).min(slope * far),
            |slope: f64| (slope * near).max(slope * far),
        );
        Cuboid {
            low: [least(left), least(top), near],
            high: [most(right), most(bottom), far],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_that_is_seen_is_in_a_box() {
        let camera = Intrinsics::centered(70.0, 100, 61);
        let range = Plane::from_fn(100, 61, |x, y| match (x * 7 + y * 13) % 11 {
            0 => f32::NAN,
            k => 0.3 + 0.4 * k as f32,
        });
        let outlook = Outlook::new(&range, &camera);
        let (surfaces, water): (Vec<_>, Vec<_>) = (outlook.surfaces().collect(), outlook.water().collect());
        let holds = |views: &[View], place: [f64; 3]| {
            let fits = |view: &&View| view.places.distances(place)[0] < 1e-9;
            views
                .iter()
                .filter(fits)
                .map(|view| view.px_per_m)
                .fold(0.0, f64::max)
        };
        for (x, y) in (0..61).flat_map(|y| (0..100).map(move |x| (x, y))) {
            let ray = camera.ray(x as f64, y as f64);
            let z = f64::from(range.pixel(x, y));
            let end = if z.is_nan() { 900.0 } else { z };
            let at = |meters: f64| <[f64; 3]>::from(ray * (meters / ray.length()));
            if !z.is_nan() {
                // A meter across the line of sight, outwards.
                let slope = ray.length();
                assert!(holds(&surfaces, at(z)) >= 70.0 * slope * slope / z * (1.0 - 1e-6));
            }
            for share in [0.0, 0.1, 0.5, 1.0] {
                assert!(holds(&water, at(share * end)) > 0.0, "{x} {y} {share}");
            }
        }
    }
}
