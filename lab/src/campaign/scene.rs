//! Random scenes: ranges from 5 cm to 200 m along one of several courses, holes, and light from even to bright points.

use imaging::random::Stream;
use imaging::{Plane, Rgb};

/// Distinct ranges of a frame: the reference takes one transform for each.
const LEVELS: f64 = 48.0;

/// A scene in air.
pub(super) struct RandomScene {
    /// Course of the range and of the light, and the size.
    pub(super) about: String,
    /// Linear light.
    pub(super) radiance: Rgb<f32>,
    /// Meters along the ray.
    pub(super) range: Plane<f32>,
}

impl RandomScene {
    /// Draws a scene with sides of at most `longest_px`.
    pub(super) fn draw(stream: &Stream, longest_px: usize) -> Self {
        let unit = |what: u64| stream.unit(u64::MAX, what);
        let pick = |what: u64, count: usize| ((unit(what) * count as f64) as usize).min(count - 1);
        let side = |what: u64| 1 + (longest_px as f64 * unit(what).powi(2)) as usize;
        let (width, height) = (side(0), side(1));
        let nearest = 0.05 * 400f64.powf(unit(2));
        let farthest = (nearest * 1.01 * 400f64.powf(unit(3))).min(200.0).max(nearest);
        let course = pick(4, COURSES.len());
        let light = pick(5, LIGHTS.len());
        let holes = if unit(6) < 0.3 { 0.2 * unit(7) } else { 0.0 };
        let peak = if unit(8) < 0.15 { 1.0 + 30.0 * unit(9) } else { 1.0 };
        let block = 2.0 + 15.0 * unit(10);
        let noise = |x: usize, y: usize, purpose: u64| stream.unit((x as u64) << 24 | y as u64, purpose);
        let place = |x: usize, y: usize| (x as f64 / width as f64, y as f64 / height as f64);
        let range = Plane::from_fn(width, height, |x, y| {
            if noise(x, y, 1) < holes {
                return [f32::NAN, 0.0, -1.0, f32::INFINITY][(x + y) % 4];
            }
            let cell = ((x as f64 / block) as usize, (y as f64 / block) as usize);
            let t = along(
                COURSES[course],
                place(x, y),
                noise(x, y, 2),
                noise(cell.0, cell.1, 3),
            );
            let level = (t.clamp(0.0, 1.0) * LEVELS).round() / LEVELS;
            (nearest * (farthest / nearest).powf(level)) as f32
        });
        let tint = [1.0 - 0.5 * unit(11), 1.0 - 0.5 * unit(12), 1.0 - 0.5 * unit(13)];
        let radiance = Rgb::from_fn(width, height, |x, y| {
            let checker = ((x as f64 / block) as usize + (y as f64 / block) as usize) % 2;
            let value = shade(LIGHTS[light], checker == 0, noise(x, y, 4), peak);
            tint.map(|tint| (tint * value) as f32)
        });
        Self {
            about: format!("{}, {}, {width}x{height}", COURSES[course], LIGHTS[light]),
            radiance,
            range,
        }
    }
}

const COURSES: [&str; 10] = [
    "wall",
    "slope",
    "noise",
    "blocks",
    "cone",
    "well",
    "far specks",
    "near specks",
    "step",
    "pole",
];
const LIGHTS: [&str; 6] = [
    "even",
    "noise",
    "salt and pepper",
    "checks",
    "lamps",
    "dark specks",
];

/// The place of a pixel between the nearest and the farthest range.
fn along(course: &str, (x, y): (f64, f64), noise: f64, block: f64) -> f64 {
    let radius = 2.0 * (x - 0.5).hypot(y - 0.5);
    match course {
        "wall" => 0.5,
        "slope" => y,
        "noise" => noise,
        "blocks" => block,
        "cone" => radius,
        "well" => 1.0 - radius,
        "far specks" => f64::from(u8::from(noise > 0.9)),
        "near specks" => f64::from(u8::from(noise < 0.9)),
        "step" => f64::from(u8::from(x > 0.5)),
        _ => {
            if (x - 0.5).abs() < 0.1 {
                0.0
            } else {
                0.6 + 0.4 * y
            }
        }
    }
}

fn shade(light: &str, even: bool, noise: f64, peak: f64) -> f64 {
    match light {
        "even" => peak,
        "noise" => peak * noise,
        "salt and pepper" => {
            if noise > 0.5 {
                peak
            } else {
                0.0
            }
        }
        "checks" => {
            if even {
                peak
            } else {
                0.05
            }
        }
        "lamps" => {
            if noise > 0.985 {
                peak
            } else {
                0.05
            }
        }
        _ => {
            if noise > 0.98 {
                0.0
            } else {
                peak
            }
        }
    }
}
