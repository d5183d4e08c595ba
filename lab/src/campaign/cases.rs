//! Random frames: every size from a pixel on, every water, both forms, ranges from 5 cm to 200 m, holes and bright lights.

use imaging::random::Stream;
use imaging::{Plane, Rgb};
use optics::preset::presets;
use optics::water::Water;
use spec::{ForwardScatter, HoleRule, Optics, ScatterModel, ScatterSource};

use super::adversary::adversary;

/// A frame to try.
#[derive(Debug, Clone)]
pub struct Case {
    /// Which one.
    pub seed: u64,
    /// Form, water, course of the range and of the light.
    pub about: String,
    /// Linear light.
    pub radiance: Rgb<f32>,
    /// Metres along the ray.
    pub range: Plane<f32>,
    /// The water.
    pub water: Water,
    /// The error that is allowed.
    pub tolerance: f64,
}

/// Distinct ranges of a frame: the reference takes one transform for each.
const LEVELS: f64 = 48.0;

/// Every so many frames one is made against the bound.
const ADVERSARIES: u64 = 40;

/// The frame of a seed.
#[must_use]
pub fn case(seed: u64) -> Case {
    let adversary = (seed % ADVERSARIES == ADVERSARIES - 1)
        .then(|| adversary(seed))
        .flatten();
    adversary.unwrap_or_else(|| random(seed))
}

fn random(seed: u64) -> Case {
    let stream = Stream::stage(seed, "campaign");
    let unit = |what: u64| stream.unit(u64::MAX, what);
    let pick = |what: u64, count: usize| ((unit(what) * count as f64) as usize).min(count - 1);
    let side = |what: u64| 1 + (80.0 * unit(what).powi(2)) as usize;
    let (width, height) = (side(0), side(1));
    let nearest = 0.05 * 400f64.powf(unit(2));
    let farthest = (nearest * 1.01 * 400f64.powf(unit(3))).min(200.0).max(nearest);
    let course = pick(4, COURSES.len());
    let light = pick(5, LIGHTS.len());
    let holes = if unit(6) < 0.3 { 0.2 * unit(7) } else { 0.0 };
    let peak = if unit(8) < 0.15 { 1.0 + 30.0 * unit(9) } else { 1.0 };
    let block = 2.0 + 15.0 * unit(10);
    let noise = |x: usize, y: usize, of: u64| stream.unit((x as u64) << 24 | y as u64, of);
    let at = |x: usize, y: usize| (x as f64 / width as f64, y as f64 / height as f64);
    let range = Plane::from_fn(width, height, |x, y| {
        if noise(x, y, 1) < holes {
            return [f32::NAN, 0.0, -1.0, f32::INFINITY][(x + y) % 4];
        }
        let cell = ((x as f64 / block) as usize, (y as f64 / block) as usize);
        let t = along(
            COURSES[course],
            at(x, y),
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
    let (water, name) = water(&unit);
    let tolerance = 10f64.powf(-1.5 - 4.0 * unit(30));
    let about = format!("{name}, {}, {}, {width}x{height}", COURSES[course], LIGHTS[light]);
    Case {
        seed,
        about,
        radiance,
        range,
        water,
        tolerance,
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

/// A preset or free coefficients, with either form. Waters that cannot be rendered are drawn again.
fn water(unit: &impl Fn(u64) -> f64) -> (Water, String) {
    for attempt in 0.. {
        let unit = |what: u64| unit(100 + 40 * attempt + what);
        let gathers = unit(0) < 0.5;
        let model = if gathers {
            ScatterModel::Simplified
        } else {
            ScatterModel::Jaffe
        };
        let source = if unit(1) < 0.2 {
            ScatterSource::Direct
        } else {
            ScatterSource::Radiance
        };
        let three =
            |least: f64, ratio: f64, from: u64| Some([0, 1, 2].map(|c| least * ratio.powf(unit(from + c))));
        let free_spread = unit(2) < 0.6;
        let scatter = ForwardScatter {
            spread_px_per_m: if free_spread { three(0.01, 300.0, 3) } else { None },
            spread_offset_px: if free_spread && unit(6) < 0.5 {
                three(0.02, 100.0, 7)
            } else {
                None
            },
            source,
            ..model.into()
        };
        let holes = if unit(10) < 0.3 {
            HoleRule::RangeM(1.0 + 30.0 * unit(11))
        } else {
            HoleRule::Background
        };
        let preset = presets().get((unit(12) * presets().len() as f64) as usize);
        let free = unit(13) < 0.4;
        let request = spec::Water {
            range_scale: 0.1 * 30f64.powf(unit(23)),
            holes,
            ..Optics {
                preset: preset.filter(|_| !free).map(|preset| preset.name.to_owned()),
                absorption_per_m: if free { three(0.01, 100.0, 14) } else { None },
                scattering_per_m: if free { three(0.01, 200.0, 17) } else { None },
                veiling_light: if free { three(0.02, 20.0, 20) } else { None },
                forward_scatter: Some(scatter),
                ..Optics::default()
            }
            .into()
        };
        let focal_px = 60.0 * 15f64.powf(unit(24));
        if let Ok(water) = Water::resolve(&request, focal_px) {
            let form = if gathers { "simplified" } else { "jaffe" };
            let name = if free {
                "free"
            } else {
                water.preset().unwrap_or("free")
            };
            let name = format!("{form}, {name}");
            return (water, name);
        }
    }
    unreachable!("some water can be rendered")
}
