//! The transfer curve and the file formats on one core at camera resolution.

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use imaging::random::Stream;
use imaging::transfer::{self, Transfer};
use imaging::{Raster, Rgb8, codec};

const WIDTH: usize = 768;
const HEIGHT: usize = 492;

/// Soft light with camera grain, triangularly distributed within ±6 codes: hard to compress, like a photograph.
fn photograph() -> Rgb8 {
    let grain = Stream::stage(1, "grain");
    Rgb8::from_fn(WIDTH, HEIGHT, |x, y| {
        let bits = grain.bits((y * WIDTH + x) as u64, 0).to_le_bytes().map(f64::from);
        let light = 120.0 + 60.0 * (x as f64 / 90.0).sin() * (y as f64 / 60.0).cos();
        let code = |channel: usize, tint: f64| {
            let grain = (bits[channel] + bits[channel + 3]) / 255.0 - 1.0;
            (light * tint + 6.0 * grain) as u8
        };
        [code(0, 0.4), code(1, 0.8), code(2, 1.0)]
    })
}

fn curves(criterion: &mut Criterion) {
    let picture = photograph();
    let raster = Raster::from(picture.clone());
    let linear = transfer::decode_rgb8(&picture);
    let encoded = transfer::encode_unit(&linear);
    let mut group = criterion.benchmark_group("transfer");
    group.bench_function("decode_rgb8", |b| {
        b.iter(|| transfer::decode_rgb8(black_box(&picture)))
    });
    group.bench_function("decode_raster", |b| {
        b.iter(|| transfer::decode_raster(black_box(&raster), Transfer::Srgb));
    });
    group.bench_function("encode_rgb8", |b| {
        b.iter(|| transfer::encode_rgb8(black_box(&linear)))
    });
    group.bench_function("encode_unit", |b| {
        b.iter(|| transfer::encode_unit(black_box(&linear)))
    });
    group.bench_function("decode_unit", |b| {
        b.iter(|| transfer::decode_unit(black_box(&encoded)))
    });
    group.finish();
}

fn formats(criterion: &mut Criterion) {
    let picture = photograph();
    let raster = Raster::from(picture.clone());
    let linear = transfer::decode_rgb8(&picture);
    let files = [
        ("png", codec::encode_png(&raster)),
        ("webp", codec::encode_webp_lossless(&picture)),
        ("jpeg", codec::encode_jpeg(&picture, 95)),
    ];
    let mut group = criterion.benchmark_group("encode");
    group.bench_function("png", |b| b.iter(|| codec::encode_png(black_box(&raster))));
    group.bench_function("webp", |b| {
        b.iter(|| codec::encode_webp_lossless(black_box(&picture)))
    });
    group.bench_function("jpeg 95", |b| {
        b.iter(|| codec::encode_jpeg(black_box(&picture), 95))
    });
    group.bench_function("npy", |b| b.iter(|| codec::encode_npy_rgb(black_box(&linear))));
    group.finish();
    let mut group = criterion.benchmark_group("decode");
    for (name, file) in files {
        let file = file.expect("the picture fits every format");
        group.bench_function(name, |b| b.iter(|| codec::decode_picture(black_box(&file))));
    }
    let npy = codec::encode_npy_rgb(&linear);
    group.bench_function("npy", |b| b.iter(|| codec::decode_radiance(black_box(&npy))));
    group.finish();
    criterion.bench_function("downscale to 256", |b| {
        b.iter(|| codec::downscale(black_box(&picture), 256))
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().measurement_time(Duration::from_secs(2)).warm_up_time(Duration::from_millis(500));
    targets = curves, formats
}
criterion_main!(benches);
