//! Haze of four lights, each truncated at some multiples of its sigma.

use imaging::Rgb;
use spec::{Haze, HazeBlend, HazeSpace};

use super::bench::{Bench, double};
use super::scenes::ChartScene;
use crate::measurement::Measurement;

/// Lights along the lower edge.
pub(super) fn lights(count: usize) -> Vec<Haze> {
    let lights = (0..count).map(|index| Haze {
        x: (index as f64 + 0.5) / count as f64,
        y: 1.0,
        size: 0.2,
        intensity: 0.8,
        color: [1.0, 0.9, 0.7],
        blend: HazeBlend::Over,
        space: HazeSpace::Linear,
    });
    lights.collect()
}

/// Measures every variant on one scene.
pub(super) fn measure(scene: &ChartScene, runs: usize) -> Vec<Measurement> {
    let lights = lights(4);
    let exact = overlay(&double(&scene.radiance), &lights, f64::INFINITY).map(|&v| v as f32);
    let single = |sigmas: f64| overlay(&double(&scene.radiance), &lights, sigmas).map(|&v| v as f32);
    let mut bench = Bench::new("haze", scene, runs);
    for sigmas in 1..=6 {
        bench.measure("cut at sigmas", Some(sigmas), &exact, || single(sigmas as f64));
    }
    bench.measure("separable", None, &exact, || {
        optics::haze(scene.radiance.clone(), &lights)
    });
    bench.measure("pixel by pixel", None, &exact, || single(f64::INFINITY));
    bench.finish("separable", None)
}

/// `I ← I (1 − α) + color α`, pixel by pixel, with α = 0 beyond `sigmas`.
pub(super) fn overlay(image: &Rgb<f64>, lights: &[Haze], sigmas: f64) -> Rgb<f64> {
    let (width, height) = image.size();
    let aspect = width as f64 / height as f64;
    Rgb::from_fn(width, height, |x, y| {
        let mut pixel = image.pixel(x, y);
        for light in lights {
            let across = ((x as f64 + 0.5) / width as f64 - light.x) * aspect;
            let down = (y as f64 + 0.5) / height as f64 - light.y;
            let squared = (across * across + down * down) / (light.size * light.size);
            if squared <= sigmas * sigmas {
                let alpha = light.intensity * (-0.5 * squared).exp();
                for (sample, color) in pixel.iter_mut().zip(light.color) {
                    *sample = *sample * (1.0 - alpha) + color * alpha;
                }
            }
        }
        pixel
    })
}
