//! Scenes for the water stage: smooth and abrupt ranges, few and many, holes, extremes.

use imaging::random::Stream;
use imaging::{Plane, Rgb};

/// A scene of any size.
#[derive(Clone, Copy)]
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    /// Ranges from 1 to 15 m and radiance up to 1: the kernel scales are within a ratio of 45.
    pub(crate) is_moderate: bool,
    /// Range in meters from fractions of width and height and a random number.
    range: fn(f32, f32, f32) -> f32,
    /// Factor of a random radiance in 0..1.
    brightness: f32,
}

pub(crate) const HOLES: Scene = Scene {
    name: "holes",
    is_moderate: true,
    range: |x, y, r| if r < 0.2 { f32::NAN } else { 2.0 + 9.0 * x * y },
    brightness: 1.0,
};

pub(crate) const SCENES: [Scene; 9] = [
    Scene {
        name: "slope",
        is_moderate: true,
        range: |x, y, _| 1.0 + 10.0 * y + 3.0 * x,
        brightness: 1.0,
    },
    Scene {
        name: "rough",
        is_moderate: true,
        range: |_, _, r| 1.0 + 14.0 * r,
        brightness: 1.0,
    },
    Scene {
        name: "flat wall",
        is_moderate: true,
        range: |_, _, _| 4.0,
        brightness: 1.0,
    },
    Scene {
        name: "pole before a wall",
        is_moderate: true,
        range: |x, _, _| if (0.4..0.6).contains(&x) { 2.0 } else { 15.0 },
        brightness: 1.0,
    },
    HOLES,
    Scene {
        name: "nothing but holes",
        is_moderate: false,
        range: |_, _, _| f32::INFINITY,
        brightness: 1.0,
    },
    Scene {
        name: "near to far",
        is_moderate: false,
        range: |x, _, r| 0.001 + 2000.0 * (x * r).powi(6),
        brightness: 1.0,
    },
    Scene {
        name: "out of sight",
        is_moderate: false,
        range: |_, y, _| 1e5 + 1e6 * y,
        brightness: 1.0,
    },
    Scene {
        name: "bright lamps",
        is_moderate: false,
        range: |x, y, _| 1.0 + 7.0 * x * y,
        brightness: 30.0,
    },
];

impl Scene {
    pub(crate) fn sized(&self, width: usize, height: usize) -> (Rgb<f32>, Plane<f32>) {
        let stream = Stream::stage(7, self.name);
        let random = |x: usize, y: usize, element: u64| stream.unit((y * width + x) as u64, element) as f32;
        let radiance = Rgb::from_fn(width, height, |x, y| {
            [0, 1, 2].map(|c| self.brightness * random(x, y, c))
        });
        let range = Plane::from_fn(width, height, |x, y| {
            (self.range)(x as f32 / width as f32, y as f32 / height as f32, random(x, y, 3))
        });
        (radiance, range)
    }
}
