//! Stages apart from the water: haze and the homomorphic filter.

use enhance::Variant;
use enhance::hscm::homomorphic::homomorphic as filter;
use enhance::hscm::{CUTOFF, Luma};
use imaging::{Plane, Raster, Rgb, transfer};
use spec::{Haze, HazeBlend, HazeSpace};

use super::difference::{Difference, difference};
use super::stopwatch::time;
use super::{ChartScene, Point};

/// Four lights along the lower edge.
pub(super) fn lights(count: usize) -> Vec<Haze> {
    let light = |index: usize| Haze {
        x: (index as f64 + 0.5) / count as f64,
        y: 1.0,
        size: 0.2,
        intensity: 0.8,
        color: [1.0, 0.9, 0.7],
        blend: HazeBlend::Over,
        space: HazeSpace::Linear,
    };
    (0..count).map(light).collect()
}

/// Haze of four lights, each truncated at some multiples of its sigma.
#[must_use]
pub fn haze(scene: &ChartScene, runs: usize) -> Vec<Point> {
    let lights = lights(4);
    let exact = overlay(&scene.radiance.map(|&v| f64::from(v)), &lights, f64::INFINITY).map(|&v| v as f32);
    let mut points = Vec::new();
    let mut add = |variant: &str, terms: Option<usize>, work: &mut dyn FnMut() -> Rgb<f32>| {
        let (times, image) = time(runs, work);
        let difference = Some(difference(&image, &exact));
        points.push(Point::new(
            "haze",
            (variant, terms),
            &scene.name,
            scene.range.size(),
            times,
            difference,
        ));
    };
    for sigmas in [1, 2, 3, 4, 5, 6] {
        let cut = || overlay(&scene.radiance, &lights, f64::from(sigmas));
        add("cut at sigmas", Some(sigmas as usize), &mut || cut());
    }
    add("separable", None, &mut || {
        optics::haze(scene.radiance.clone(), &lights)
    });
    add("pixel by pixel", None, &mut || {
        overlay(&scene.radiance, &lights, f64::INFINITY)
    });
    points
        .iter_mut()
        .for_each(|point| point.default = point.variant == "separable");
    points
}

/// `I ← I (1 − α) + color α`, pixel by pixel, with α = 0 beyond `sigmas`.
pub(super) fn overlay<T: Into<f64> + std::marker::Copy + FromDouble>(
    image: &Rgb<T>,
    lights: &[Haze],
    sigmas: f64,
) -> Rgb<T> {
    let (width, height) = image.size();
    let aspect = width as f64 / height as f64;
    Rgb::from_fn(width, height, |x, y| {
        let mut pixel = image.pixel(x, y).map(Into::into);
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
        pixel.map(T::from_double)
    })
}

/// f32 or f64.
pub(super) trait FromDouble {
    fn from_double(value: f64) -> Self;
}

impl FromDouble for f32 {
    fn from_double(value: f64) -> Self {
        value as f32
    }
}

impl FromDouble for f64 {
    fn from_double(value: f64) -> Self {
        value
    }
}

/// The homomorphic filter of HSCM: the fast variant and the transform in f64, for narrow and wide cut-offs.
#[must_use]
pub fn homomorphic(scene: &ChartScene, runs: usize) -> Vec<Point> {
    let picture = Raster::from(transfer::encode_rgb8(&scene.radiance).0);
    let luma = Luma::new(&picture);
    let mut points = Vec::new();
    for cutoff in [8.0, 32.0, 96.0] {
        let (slow, exact) = time(runs, || filter(&luma, cutoff, Variant::Reference));
        let (fast, codes) = time(runs, || filter(&luma, cutoff, Variant::Fast));
        for (variant, times, result) in [("separable", fast, &codes), ("transform in f64", slow, &exact)] {
            let difference = Some(grey(result, &exact));
            let terms = Some(cutoff as usize);
            let mut point = Point::new(
                "homomorphic",
                (variant, terms),
                &scene.name,
                scene.range.size(),
                times,
                difference,
            );
            point.default = variant == "separable" && cutoff == CUTOFF;
            points.push(point);
        }
    }
    points
}

fn grey(codes: &Plane<u8>, exact: &Plane<u8>) -> Difference {
    let linear = |plane: &Plane<u8>| {
        let plane = plane.map(|&code| transfer::decode_u8(code));
        Rgb::new([plane.clone(), plane.clone(), plane]).expect("planes of one size")
    };
    difference(&linear(codes), &linear(exact))
}
