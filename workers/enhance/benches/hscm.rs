//! HSCM stage by stage on one core at camera resolution.

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use enhance::hscm::homomorphic::{self, Filter};
use enhance::hscm::{Luma, clahe, median, merge};
use enhance::mask;
use enhance::{Method, Variant};
use imaging::{Raster, Rgb8};
use spec::{Circle, Hscm};

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

fn stages(criterion: &mut Criterion) {
    let colors = picture();
    let raster = Raster::from(colors.clone());
    let luma = Luma::new(&raster);
    let filter = Filter::new(&Hscm::default(), WIDTH);
    let filtered = homomorphic::homomorphic(&luma, &filter, Variant::Fast);
    let smoothed = median::median(&filtered, 5, Variant::Fast);
    let equalized = clahe::clahe(&smoothed, [8, 8], 2.0);

    let mut group = criterion.benchmark_group("hscm");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2));
    group.bench_function("luma", |b| b.iter(|| Luma::new(black_box(&raster))));
    for (name, variant) in [
        ("homomorphic", Variant::Fast),
        ("homomorphic_reference", Variant::Reference),
    ] {
        group.bench_function(name, |b| {
            b.iter(|| homomorphic::homomorphic(black_box(&luma), &filter, variant));
        });
    }
    group.bench_function("homomorphic_log", |b| {
        b.iter(|| homomorphic::filtered_log(black_box(&luma), &filter, Variant::Fast));
    });
    group.bench_function("median_5", |b| {
        b.iter(|| median::median(black_box(&filtered), 5, Variant::Fast))
    });
    group.bench_function("clahe", |b| {
        b.iter(|| clahe::clahe(black_box(&smoothed), [8, 8], 2.0));
    });
    group.bench_function("merge", |b| {
        b.iter(|| merge::merge(black_box(colors.data()), equalized.data()))
    });
    let paper = Circle::PAPER;
    group.bench_function("circle", |b| {
        b.iter(|| mask::circle_plane(WIDTH, HEIGHT, black_box(&paper)));
    });
    let method = Method::parse("hscm").expect("a name of the table");
    group.bench_function("whole", |b| b.iter(|| enhance::run(&method, black_box(&raster))));
    group.finish();
}

criterion_group!(benches, stages);
criterion_main!(benches);
