//! Clouds in f64: one ray in fine steps for every pixel.

use imaging::{Plane, Rgb};

use super::{Clouds, Drift, FAR_M, Murk, end};
use crate::lit_point::LitPoint;

/// Steps of the longest ray.
const STEPS: f64 = 600.0;

/// Composites the clouds over a picture in linear light; returns it and their opacity in green. A hole is infinite.
#[must_use]
pub fn veil_reference(
    image: &Rgb<f64>,
    range: &Plane<f32>,
    clouds: &Clouds,
    murk: &Murk<'_>,
) -> (Rgb<f64>, Plane<f64>) {
    let (width, height) = image.size();
    let pixel = |x: usize, y: usize| {
        let end = end(range.pixel(x, y));
        let ray = clouds.eye.ray(x as f64, y as f64);
        let count = (STEPS * end / FAR_M).ceil().max(1.0);
        let step = end / count;
        let (mut added, mut clear) = ([0.0; 3], [1.0; 3]);
        let drifts: Vec<Drift> = Drift::along(clouds, ray, count as usize, step).collect();
        let points: Vec<LitPoint> = drifts.iter().map(|drift| drift.point(1.0)).collect();
        let colors = clouds.colors(murk, &points);
        for (drift, color) in drifts.iter().zip(colors) {
            let through = drift.through(murk);
            for i in 0..3 {
                let share = drift.stopped * through[i];
                added[i] += clear[i] * share * color[i];
                clear[i] *= 1.0 - share;
            }
        }
        let behind = image.pixel(x, y);
        ([0, 1, 2].map(|i| behind[i] * clear[i] + added[i]), 1.0 - clear[1])
    };
    (
        Rgb::from_fn(width, height, |x, y| pixel(x, y).0),
        Plane::from_fn(width, height, |x, y| pixel(x, y).1),
    )
}
