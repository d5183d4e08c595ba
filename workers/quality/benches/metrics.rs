//! Metrics separately and together on one core at camera resolution.

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use imaging::Rgb8;
use quality::{MetricId, Needs, measure};

const WIDTH: usize = 869;
const HEIGHT: usize = 565;
const DEFAULTS: [&str; 6] = ["entropy", "uicm", "uism", "uiconm", "uiqm", "uciqe"];

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

fn metrics(criterion: &mut Criterion) {
    let picture = picture();
    let mut clean = picture.clone();
    clean.data_mut().reverse();
    let mut group = criterion.benchmark_group("metric");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    let alone = |id: &MetricId| matches!(id.info().needs, Needs::Nothing | Needs::PictureInAir);
    for id in MetricId::all().filter(alone) {
        group.bench_function(id.to_string(), |b| {
            b.iter(|| measure(black_box(&picture), Some(&clean), &[id]))
        });
    }
    let defaults: Vec<MetricId> = DEFAULTS.into_iter().filter_map(MetricId::parse).collect();
    group.bench_function("six_defaults", |b| {
        b.iter(|| measure(black_box(&picture), None, &defaults))
    });
    let unreferenced: Vec<MetricId> = MetricId::all()
        .filter(|id| id.info().needs == Needs::Nothing)
        .collect();
    group.bench_function("all_unreferenced", |b| {
        b.iter(|| measure(black_box(&picture), None, &unreferenced))
    });
    group.finish();
}

criterion_group!(benches, metrics);
criterion_main!(benches);
