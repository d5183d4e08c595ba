//! Hill climbing against the rounding bounds of defocus and geometry: samples change one by one, and a change is kept
//! if it brings the error closer to the bound.
#![allow(clippy::unwrap_used)]

use camera::defocus;
use camera::geometry::{self, Lens, PortRefraction, Sampling, SourcePicture};
use imaging::geometry::Intrinsics;
use imaging::random::Stream;
use imaging::{Plane, Rgb};
use spec::Distortion;

/// Changes per start; overridden by `FATHOM_CLIMB_STEPS`.
const STEPS: u64 = 600;

fn steps() -> u64 {
    let steps = std::env::var("FATHOM_CLIMB_STEPS").ok();
    steps.map_or(STEPS, |steps| steps.parse().unwrap())
}

/// The largest ratio of error to bound found by climbing; `ratio` evaluates a picture with samples of 0 to 1.
fn climb(seed: u64, size: (usize, usize), ratio: impl Fn(&Rgb<f32>) -> f64) -> f64 {
    let stream = Stream::stage(seed, "climb");
    let start = |x: usize, y: usize, c: usize| match seed % 3 {
        0 => stream.unit(x as u64, (3 * y + c) as u64) as f32,
        1 => ((x + y + c) % 2) as f32,
        _ => 1.0 - 1e-3 * stream.unit(x as u64, (3 * y + c) as u64) as f32,
    };
    let mut best = Rgb::from_fn(size.0, size.1, |x, y| [0, 1, 2].map(|c| start(x, y, c)));
    let mut largest = ratio(&best);
    let samples = (size.0 * size.1) as f64;
    for step in 0..steps() {
        let unit = |element: u64| stream.unit(step, 1000 + element);
        let mut changed = best.clone();
        for change in 0..1 + (3.0 * unit(0)) as u64 {
            let sample = (unit(3 * change + 1) * samples) as usize;
            let plane = (unit(3 * change + 2) * 3.0) as usize;
            let value = &mut changed.planes_mut()[plane][sample];
            let kick = unit(3 * change + 3) as f32;
            *value = match step % 3 {
                0 => kick,
                1 => kick.round(),
                _ => (*value + 1e-3 * (kick - 0.5)).clamp(0.0, 1.0),
            };
        }
        let next = ratio(&changed);
        if next >= largest {
            (best, largest) = (changed, next);
        }
    }
    largest
}

fn worst(exact: &Rgb<f64>, fast: &Rgb<f32>) -> f64 {
    let planes = exact.planes().iter().zip(fast.planes());
    let pairs = planes.flat_map(|(exact, fast)| exact.data().iter().zip(fast.data()));
    pairs.map(|(e, &f)| (e - f64::from(f)).abs()).fold(0.0, f64::max)
}

#[test]
fn no_picture_is_blurred_beyond_the_bound() {
    let size = (9, 5);
    for (number, radius) in [0.6, 1.0, 1.7, 3.0, 4.4].into_iter().enumerate() {
        for spread in [0.0, 0.4] {
            let radii = Plane::from_fn(size.0, size.1, |x, y| radius + spread * ((x + 2 * y) % 5) as f64);
            let bound = defocus::rounding_bound(radius + 4.0 * spread, 1.0);
            let ratio = |picture: &Rgb<f32>| {
                let exact = defocus::blur_reference(&picture.map(|&v| f64::from(v)), &radii);
                worst(&exact, &defocus::blur(picture, &radii)) / bound
            };
            let found = (0..3).map(|seed| climb(seed + 3 * number as u64, size, ratio));
            let largest = found.fold(0.0, f64::max);
            println!(
                "radius {radius} to {}: error/bound {largest:.3}",
                radius + 4.0 * spread
            );
            assert!(largest <= 1.0, "radius {radius}: {largest}");
        }
    }
}

#[test]
fn no_picture_is_sampled_beyond_the_bound() {
    let size = (7, 5);
    for (number, supersample) in [1, 2, 3].into_iter().enumerate() {
        let lens = Lens {
            camera: Intrinsics::centered(6.0, size.0, size.1),
            distortion: Distortion {
                k1: 0.1,
                p1: 0.01,
                ..Distortion::default()
            },
            refraction: PortRefraction::Flat {
                index: [1.33, 1.34, 1.35],
            },
        };
        lens.check(size).unwrap();
        let source = SourcePicture::covering(&lens, size, supersample).unwrap();
        let sampling = Sampling::new(&geometry::coordinates(&lens, &source, size), source.size);
        let maps = [0, 1, 2].map(|c| geometry::coordinates_reference(&lens, &source, size, c));
        let bound = geometry::sampling_bound(&source, 1.0, 1.0);
        let ratio = |picture: &Rgb<f32>| {
            let wide = picture.map(|&v| f64::from(v));
            let planes = [0, 1, 2].map(|c| geometry::resample_reference(&wide.planes()[c], &maps[c]));
            worst(&Rgb::new(planes).unwrap(), &sampling.picture(picture)) / bound
        };
        let found = (0..3).map(|seed| climb(seed + 3 * number as u64, source.size, ratio));
        let largest = found.fold(0.0, f64::max);
        println!("supersample {supersample}: error/bound {largest:.3}");
        assert!(largest <= 1.0, "supersample {supersample}: {largest}");
    }
}
