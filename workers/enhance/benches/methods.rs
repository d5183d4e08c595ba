//! All methods and their building blocks on one core at camera resolution.

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use enhance::blocks::{Guide, guided, largest};
use enhance::{METHODS, Method, Variant, run};
use imaging::{Plane, Raster, Rgb8};

const WIDTH: usize = 869;
const HEIGHT: usize = 565;

/// Soft light, edges and grain, with about as many distinct colors as a photograph.
fn picture() -> Rgb8 {
    Rgb8::from_fn(WIDTH, HEIGHT, |x, y| {
        let (u, v) = (x as f64 / WIDTH as f64, y as f64 / HEIGHT as f64);
        let light = 0.25 + 0.6 * (-4.0 * ((u - 0.4).powi(2) + (v - 0.3).powi(2))).exp();
        let plate = if (x / 97 + y / 61) % 3 == 0 { 0.75 } else { 1.0 };
        let mut hash = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77);
        hash = (hash ^ (hash >> 15)).wrapping_mul(0x2c1b_3c6d);
        let grain = f64::from(hash >> 24) / 255.0 - 0.5;
        [0.5, 0.8, 0.9].map(|tint| (255.0 * (light * plate * tint + 0.04 * grain)).clamp(0.0, 255.0) as u8)
    })
}

fn methods(criterion: &mut Criterion) {
    let colors = picture();
    let raster = Raster::from(colors.clone());
    let mut group = criterion.benchmark_group("method");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2));
    for name in METHODS {
        let method = Method::parse(name).expect("a name of the registry");
        group.bench_function(*name, |b| b.iter(|| run(&method, black_box(&raster))));
    }
    group.finish();

    let mut group = criterion.benchmark_group("block");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(1));
    let guide = Guide::new(&colors);
    let plane = Plane::from_fn(WIDTH, HEIGHT, |x, y| f64::from(colors.pixel(x, y)[0]) / 255.0);
    group.bench_function("guide", |b| b.iter(|| Guide::new(black_box(&colors))));
    group.bench_function("guided", |b| {
        b.iter(|| guided(&guide, black_box(&plane), Variant::Fast))
    });
    group.bench_function("largest", |b| {
        b.iter(|| largest(black_box(&plane), 491, Variant::Fast))
    });
    group.finish();
}

criterion_group!(benches, methods);
criterion_main!(benches);
