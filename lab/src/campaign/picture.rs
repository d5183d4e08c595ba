//! Random pictures: ranges from 5 cm to 200 m in one of several patterns, holes, and light from black to bright points.

use imaging::{Plane, Rgb};

use super::case::Picture;
use super::knobs::Knobs;

/// Distinct ranges of a frame. The reference runs one transform for each.
const LEVELS: f64 = 48.0;
/// Patterns of range.
pub(super) const COURSES: [&str; 12] = [
    "wall", "slope", "noise", "blocks", "cone", "well", "far", "near", "step", "pole", "needles", "stripes",
];
/// Patterns of light.
pub(super) const LIGHTS: [&str; 10] = [
    "even", "noise", "salt", "checks", "lamps", "specks", "ramp", "point", "signs", "side",
];

/// Patterns at the start of [`LIGHTS`] with many bright pixels.
pub(super) const BRIGHT: usize = 6;
/// The random number for a brightest pixel below white.
pub(super) const DIM: f64 = 0.2;
/// The random number for a brightest pixel at white.
pub(super) const WHITE: f64 = 0.6;

/// Shortest and longest side and the largest area of a picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    pub(super) sides_px: (usize, usize),
    pub(super) pixels: usize,
}

impl Limits {
    pub(super) const fn new(sides_px: (usize, usize), pixels: usize) -> Self {
        Self { sides_px, pixels }
    }
}

/// Draws the sides of a picture within limits.
pub(super) fn draw_sides(knobs: &Knobs, limits: Limits) -> (usize, usize) {
    let (least, most) = limits.sides_px;
    let width = knobs.whole("picture.width", least, most);
    let height = knobs.whole("picture.height", least, most);
    (width, height.min(limits.pixels / width).max(1))
}

/// Draws a picture.
pub(super) fn draw_picture(knobs: &Knobs, limits: Limits) -> Picture {
    let (width, height) = draw_sides(knobs, limits);
    let block = knobs.within("picture.block", 2.0, 17.0);
    let range = draw_range(knobs, (width, height), block);
    let course = knobs.pick("picture.light", &LIGHTS);
    let peak = draw_peak(knobs);
    let dim = peak * knobs.log("picture.dim", 1e-4, 0.2);
    let stream = knobs.stream("picture.noise");
    let spot = (
        knobs.whole("picture.x", 0, width - 1),
        knobs.whole("picture.y", 0, height - 1),
    );
    let tint = knobs.within_rgb("picture.tint", 0.5, 1.0);
    let radiance = Rgb::from_fn(width, height, |x, y| {
        let check = (x as f64 / block) as usize + (y as f64 / block) as usize;
        let noise = stream.unit(address(x, y), 0);
        let is_bright = match *course {
            "even" | "noise" | "ramp" => true,
            "salt" => noise > 0.5,
            "checks" => check.is_multiple_of(2),
            "lamps" => noise > 0.985,
            "specks" => noise < 0.98,
            "point" => (x, y) == spot,
            "signs" => (x + y).is_multiple_of(2),
            _ => x * 2 > width,
        };
        let part = match *course {
            "noise" => noise,
            "ramp" => (x as f64 + 1.0) / width as f64,
            _ => 1.0,
        };
        let value = if is_bright { peak * part } else { dim * noise };
        tint.map(|tint| (tint * value) as f32)
    });
    Picture { radiance, range }
}

/// Light of the brightest pixels: black, below white, white or above.
fn draw_peak(knobs: &Knobs) -> f64 {
    match knobs.unit("picture.kind") {
        kind if kind < 0.03 => 0.0,
        kind if kind < 0.4 => knobs.log("picture.peak", 1e-5, 1.0),
        kind if kind < 0.85 => 1.0,
        _ => knobs.within("picture.peak", 1.0, 31.0),
    }
}

fn draw_range(knobs: &Knobs, (width, height): (usize, usize), block: f64) -> Plane<f32> {
    let nearest = knobs.log("range.nearest", 0.05, 20.0);
    let farthest = (nearest * knobs.log("range.reach", 1.01, 404.0))
        .min(200.0)
        .max(nearest);
    let course = knobs.pick("range.course", &COURSES);
    let has_holes = knobs.chance("range.has_holes", 0.3);
    let holes = if has_holes {
        knobs.within("range.holes", 0.0, 0.2)
    } else {
        0.0
    };
    let stream = knobs.stream("range.noise");
    Plane::from_fn(width, height, |x, y| {
        if stream.unit(address(x, y), 1) < holes {
            return [f32::NAN, 0.0, -1.0, f32::INFINITY][(x + y) % 4];
        }
        let cell = address((x as f64 / block) as usize, (y as f64 / block) as usize);
        let place = (x as f64 / width as f64, y as f64 / height as f64);
        let t = match *course {
            "needles" => f64::from(u8::from(stream.unit(address(x, 0), 4) < 0.8)),
            "stripes" => f64::from(u8::from(x.is_multiple_of(2))),
            course => along(course, place, stream.unit(address(x, y), 2), stream.unit(cell, 3)),
        };
        let level = (t.clamp(0.0, 1.0) * LEVELS).round() / LEVELS;
        (nearest * (farthest / nearest).powf(level)) as f32
    })
}

/// Relative position between the nearest and the farthest range.
fn along(course: &str, (x, y): (f64, f64), noise: f64, block: f64) -> f64 {
    let radius = 2.0 * (x - 0.5).hypot(y - 0.5);
    match course {
        "wall" => 0.5,
        "slope" => y,
        "noise" => noise,
        "blocks" => block,
        "cone" => radius,
        "well" => 1.0 - radius,
        "far" => f64::from(u8::from(noise > 0.9)),
        "near" => f64::from(u8::from(noise < 0.9)),
        "step" => f64::from(u8::from(x > 0.5)),
        _ if (x - 0.5).abs() < 0.1 => 0.0,
        _ => 0.6 + 0.4 * y,
    }
}

fn address(x: usize, y: usize) -> u64 {
    (x as u64) << 24 | y as u64
}
