//! Scenes for measuring variants.

use imaging::geometry::Intrinsics;
use imaging::random::Stream;
use imaging::{Plane, Rgb};
use optics::range::is_hole;

/// A scene in air with its range.
#[derive(Debug, Clone)]
pub(super) struct ChartScene {
    /// Its name in the data.
    pub(super) name: String,
    /// Linear light.
    pub(super) radiance: Rgb<f32>,
    /// Meters along the ray.
    pub(super) range: Plane<f32>,
}

/// Distinct ranges of a scene. The reference needs one transform for each, which is minutes at full size with this many. No variant
/// benefits from it, since all use far fewer kernels.
const LEVELS: f32 = 64.0;

impl ChartScene {
    /// A scene with ranges rounded to 64 steps in a geometric progression between the nearest and the farthest. Holes are kept.
    pub(super) fn new(name: &str, radiance: Rgb<f32>, range: &Plane<f32>) -> Self {
        let valid = range.data().iter().filter(|z| !is_hole(**z));
        let (nearest, farthest) = valid.fold((f32::INFINITY, 0.0f32), |(near, far), &z| {
            (near.min(z), far.max(z))
        });
        let step = ((farthest / nearest).ln() / (LEVELS - 1.0)).max(f32::MIN_POSITIVE);
        Self {
            name: name.to_owned(),
            radiance,
            range: range.map(|&z| match is_hole(z) || farthest <= nearest {
                true => z,
                false => nearest * (step * ((z / nearest).ln() / step).round()).exp(),
            }),
        }
    }
}

/// The focal length of a camera of 80° across.
pub(super) fn focal_px(width: usize) -> f64 {
    width as f64 / (2.0 * 40f64.to_radians().tan())
}

/// The standard scenes: a flat wall, a slope, a pole in front of a far background, a slope with holes, and a procedural structure.
pub(super) fn standard_scenes(width: usize) -> Vec<ChartScene> {
    let height = (width * 492 / 768).max(1);
    let slope = Plane::from_fn(width, height, |_, y| 1.0 + 14.0 * (y as f32 / height as f32));
    let stream = Stream::stage(7, "chart/holes");
    let pole = Plane::from_fn(width, height, |x, y| {
        match (2 * width / 5..width / 2).contains(&x) {
            true => 1.0,
            false => 10.0 + 5.0 * (y as f32 / height as f32),
        }
    });
    let holes = Plane::from_fn(width, height, |x, y| {
        let is_hole = y < height / 5 || stream.unit((x / 9) as u64, (y / 9) as u64) < 0.1;
        if is_hole { f32::NAN } else { slope.pixel(x, y) }
    });
    let wall = Plane::filled(width, height, 5.0);
    let ranges = [
        ("wall", &wall),
        ("slope", &slope),
        ("pole", &pole),
        ("holes", &holes),
    ];
    let mut all: Vec<ChartScene> = ranges
        .map(|(name, range)| ChartScene::new(name, pattern(width, height), range))
        .into();
    let camera = Intrinsics::centered(focal_px(width), width, height);
    let scene = scenes::procedural("structure", 7, width, height, camera).expect("a known family");
    let range = scene.range.expect("procedural scenes have range");
    all.push(ChartScene::new("structure", scene.radiance, &range));
    all
}

/// Stripes, noise and a few small lights, for content at every spatial frequency.
fn pattern(width: usize, height: usize) -> Rgb<f32> {
    let stream = Stream::stage(3, "chart/pattern");
    Rgb::from_fn(width, height, |x, y| {
        let stripe = if (x / 37 + y / 23) % 2 == 0 { 0.75 } else { 0.1 };
        let noise = 0.15 * stream.unit(x as u64, y as u64) as f32;
        let lamp = if x % 97 < 3 && y % 89 < 3 { 1.0 } else { 0.0 };
        [stripe + noise, 0.7 * stripe + noise, 0.8 - 0.7 * stripe + noise].map(|v: f32| v.max(lamp))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_few_and_close_to_what_they_were() {
        for scene in standard_scenes(60) {
            let mut ranges: Vec<u32> = scene.range.data().iter().map(|z| z.to_bits()).collect();
            ranges.sort_unstable();
            ranges.dedup();
            assert!(ranges.len() <= LEVELS as usize + 1, "{}", scene.name);
        }
        let range = Plane::from_fn(50, 1, |x, _| 1.0 + x as f32);
        let rounded = ChartScene::new("slope", pattern(50, 1), &range).range;
        for (a, b) in range.data().iter().zip(rounded.data()) {
            assert!((a / b - 1.0).abs() < 0.04, "{a} became {b}");
        }
    }
}
