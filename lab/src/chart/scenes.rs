//! Scenes for measuring variants.

use imaging::random::Stream;
use imaging::{Plane, Rgb};

/// A scene in air with its range.
#[derive(Debug, Clone)]
pub struct ChartScene {
    /// Its name in the data.
    pub name: String,
    /// Linear light.
    pub radiance: Rgb<f32>,
    /// Meters along the ray.
    pub range: Plane<f32>,
}

/// Distinct ranges of a scene. The reference needs one transform for each, which is minutes at full size with this many. No variant
/// benefits from it, since all use far fewer kernels.
const LEVELS: f32 = 64.0;

impl ChartScene {
    /// A scene with ranges rounded to 64 steps in a geometric progression between the nearest and the farthest. Holes are kept.
    #[must_use]
    pub fn new(name: &str, radiance: Rgb<f32>, range: &Plane<f32>) -> Self {
        let valid = |z: f32| !optics::range::is_hole(z);
        let (nearest, farthest) = range
            .data()
            .iter()
            .filter(|z| valid(**z))
            .fold((f32::INFINITY, 0.0f32), |(near, far), &z| {
                (near.min(z), far.max(z))
            });
        let step = ((farthest / nearest).ln() / (LEVELS - 1.0)).max(f32::MIN_POSITIVE);
        let rounded = |z: f32| nearest * (step * ((z / nearest).ln() / step).round()).exp();
        let round = |&z: &f32| {
            if valid(z) && farthest > nearest {
                rounded(z)
            } else {
                z
            }
        };
        Self {
            name: name.to_owned(),
            radiance,
            range: range.map(round),
        }
    }
}

/// The standard scenes: a flat wall, a slope, a pole in front of a far background, and a slope with holes.
#[must_use]
pub fn standard_scenes(width: usize, height: usize) -> Vec<ChartScene> {
    let down = |y: usize| y as f32 / height as f32;
    let slope = |y: usize| 1.0 + 14.0 * down(y);
    let is_pole = |x: usize| (2 * width / 5..width / 2).contains(&x);
    let stream = Stream::stage(7, "chart/holes");
    let is_hole = |x: usize, y: usize| {
        let (across, along) = ((x / 9) as u64, (y / 9) as u64);
        y < height / 5 || stream.unit(across, along) < 0.1
    };
    let scene = |name: &str, range: &dyn Fn(usize, usize) -> f32| {
        ChartScene::new(
            name,
            pattern(width, height),
            &Plane::from_fn(width, height, range),
        )
    };
    vec![
        scene("wall", &|_, _| 5.0),
        scene("slope", &|_, y| slope(y)),
        scene("pole", &|x, y| {
            if is_pole(x) { 1.0 } else { 10.0 + 5.0 * down(y) }
        }),
        scene("holes", &|x, y| if is_hole(x, y) { f32::NAN } else { slope(y) }),
    ]
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
        for scene in standard_scenes(60, 40) {
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
