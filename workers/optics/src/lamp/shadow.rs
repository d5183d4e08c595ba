//! Occlusion of a lamp.
//!
//! A lamp is a point, or a sphere with N light samples: those of a disc about its center across the ray to it, at the radii `R
//! sqrt((k + 1/2)/N)` and the angles 2.399963229728653 k, the golden angle, in the frame of Duff et al. (2017) about the ray. The
//! visible share has steps of 1/N. The samples are not random, so that a shadow does not flicker.

use imaging::rays::{RayStart, Rays};
use imaging::vector::dot;

/// The golden angle.
const TURN: f64 = 2.399_963_229_728_653;
/// Samples of the disc of scattered lamp light.
pub(super) const SPREAD_PLACES: usize = 16;
/// For a straight edge across a disc of N samples, the occluded share of samples differs by up to this times N^(−3/4) from the
/// share of the area, for N up to 256.
const EDGE_ERROR: f64 = 1.4;
/// Light samples of a lamp with a radius.
const SAMPLES: usize = 16;

/// Shadow mode of a lamp.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Shadow {
    /// Not at all.
    #[default]
    None,
    /// With sharp edges: the lamp is a point.
    Hard,
    /// With soft edges: the lamp is a sphere.
    Soft {
        /// Its radius, m.
        radius_m: f64,
        /// Light samples.
        samples: usize,
    },
}

impl Shadow {
    /// The shadow in the light of a lamp of this radius: of a point without one.
    pub(super) fn of_lamp(radius_m: f64) -> Self {
        if radius_m == 0.0 {
            return Self::Hard;
        }
        Self::Soft {
            radius_m,
            samples: SAMPLES,
        }
    }

    /// Radius and number of the light samples of a lamp.
    pub(crate) fn disc(self) -> (f64, usize) {
        match self {
            Self::None | Self::Hard => (0.0, 1),
            Self::Soft { radius_m, samples } => (radius_m, samples),
        }
    }
}

/// Sample `k` of `count` on a disc of this radius about `middle`, perpendicular to the unit vector `toward` to it.
pub(super) fn disc_place(
    middle: [f64; 3],
    toward: [f64; 3],
    radius_m: f64,
    (k, count): (usize, usize),
) -> [f64; 3] {
    let [x, y, z] = toward;
    let sign = if z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    let first = [1.0 + sign * x * x * a, sign * b, -sign * x];
    let second = [b, sign + y * y * a, -y];
    let [u, v] = on_unit_disc(k, count);
    [0, 1, 2].map(|i| middle[i] + radius_m * (u * first[i] + v * second[i]))
}

/// Sample `k` of `count` on a disc of radius 1.
pub(crate) fn on_unit_disc(k: usize, count: usize) -> [f64; 2] {
    let out = ((k as f64 + 0.5) / count as f64).sqrt();
    let (sin, cos) = (TURN * k as f64).sin_cos();
    [out * cos, out * sin]
}

/// Number of samples for an error of at most this in the visible share past a straight edge, relative to more samples.
pub(crate) fn places_within(error: f64) -> usize {
    (2.0 * EDGE_ERROR / error).powf(4.0 / 3.0).ceil().max(1.0) as usize
}

/// The sample of a disc for node `node` of a ray through the water: neighbors use distant ones.
pub(super) fn shared_place(node: usize, count: usize) -> usize {
    let stride = if count.is_multiple_of(7) { 5 } else { 7 };
    stride * node % count
}

/// Whether a point is visible from the start of a ray.
pub(super) fn sees(rays: &dyn Rays, start: RayStart, place: [f64; 3]) -> bool {
    let way = [0, 1, 2].map(|i| place[i] - start.origin[i]);
    let meters = dot(way, way).sqrt();
    meters <= start.from || !rays.occluded(start.origin, way.map(|v| v / meters), start.from, meters)
}

/// Visible share of a disc about `middle` from the start of a ray.
pub(super) fn share_seen(
    rays: &dyn Rays,
    start: RayStart,
    middle: [f64; 3],
    (radius_m, count): (f64, usize),
) -> f64 {
    if radius_m == 0.0 {
        return if sees(rays, start, middle) { 1.0 } else { 0.0 };
    }
    let way = [0, 1, 2].map(|i| middle[i] - start.origin[i]);
    let meters = dot(way, way).sqrt();
    if meters <= start.from {
        return 1.0;
    }
    let toward = way.map(|v| v / meters);
    let seen = (0..count).filter(|&k| sees(rays, start, disc_place(middle, toward, radius_m, (k, count))));
    seen.count() as f64 / count as f64
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn straight_edges_hide_as_much_of_a_disc_as_is_said() {
        let area = |x: f64| {
            let x = x.clamp(-1.0, 1.0);
            (x.acos() - x * (1.0 - x * x).sqrt()) / PI
        };
        for count in 1..=256 {
            let most = EDGE_ERROR * (count as f64).powf(-0.75);
            for turn in 0..180 {
                let (sin, cos) = (PI * f64::from(turn) / 90.0).sin_cos();
                let along = |k| {
                    let [u, v] = on_unit_disc(k, count);
                    u * cos + v * sin
                };
                let mut across: Vec<f64> = (0..count).map(along).collect();
                across.sort_by(f64::total_cmp);
                for (hidden, &x) in across.iter().enumerate() {
                    for hidden in [hidden, hidden + 1] {
                        let seen = (count - hidden) as f64 / count as f64;
                        assert!(
                            (seen - area(x)).abs() <= most,
                            "{count} {turn}: {seen} {}",
                            area(x)
                        );
                    }
                }
            }
        }
        assert_eq!([f64::INFINITY, 2.8, 0.1].map(places_within), [1, 1, 86]);
        assert!(places_within(1e-9) > 256 && places_within(0.0) > 256);
    }

    #[test]
    fn the_places_of_a_disc_lie_across_the_way_and_fill_it() {
        for toward in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.6, -0.48, 0.64]] {
            let middle = [1.0, 2.0, -3.0];
            let places: Vec<_> = (0..64)
                .map(|k| disc_place(middle, toward, 0.5, (k, 64)))
                .map(|place| [0, 1, 2].map(|i| place[i] - middle[i]))
                .collect();
            for place in &places {
                assert!(dot(*place, toward).abs() < 1e-12);
                assert!(dot(*place, *place).sqrt() <= 0.5);
            }
            let mean = [0, 1, 2].map(|i| places.iter().map(|place| place[i]).sum::<f64>() / 64.0);
            assert!(dot(mean, mean).sqrt() < 0.02, "{mean:?}");
            let inner = places.iter().filter(|place| dot(**place, **place).sqrt() < 0.25);
            assert_eq!(inner.count(), 16);
        }
    }
}
