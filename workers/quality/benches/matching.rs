//! Features, matches, pose and illumination residual of a frame of 768 × 492 on one core.

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use imaging::vector::{DVec3, vec3};
use imaging::{Plane, Rgb8};
use quality::{FrameFeatures, Illumination, MatchedRays, RayPair, TrueLight, estimate_pose, match_features};

const WIDTH: usize = 768;
const HEIGHT: usize = 492;
const FOCAL_PX: f64 = 500.0;

fn hash(x: usize, y: usize) -> f64 {
    let mut hash = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77);
    hash = (hash ^ (hash >> 15)).wrapping_mul(0x2c1b_3c6d);
    f64::from(hash >> 24) / 255.0
}

/// Stones of several sizes and grain, shifted to the left. The contrast is in codes.
fn picture(shift: usize, contrast: f64) -> Rgb8 {
    Rgb8::from_fn(WIDTH, HEIGHT, |x, y| {
        let u = x + shift;
        let stones = hash(u / 23, y / 19) + hash(u / 9, y / 7) + hash(u / 4, y / 5);
        [(120.0 + contrast * (stones / 3.0 - 0.5) + 4.0 * (hash(x, y) - 0.5)) as u8; 3]
    })
}

fn ray(x: f32, y: f32) -> DVec3 {
    let (x, y) = (
        f64::from(x) - WIDTH as f64 / 2.0,
        f64::from(y) - HEIGHT as f64 / 2.0,
    );
    vec3(x / FOCAL_PX, y / FOCAL_PX, 1.0).normalized()
}

fn matching(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("matching");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    // In the pale picture the thresholds select different features.
    for (name, contrast) in [("clear", 220.0), ("pale", 40.0)] {
        let [current, previous] = [6, 0].map(|shift| picture(shift, contrast));
        let before = FrameFeatures::find(&previous, None);
        group.bench_function(format!("features_{name}"), |b| {
            b.iter(|| FrameFeatures::find(black_box(&current), None))
        });
        group.bench_function(format!("features_and_matches_{name}"), |b| {
            b.iter(|| {
                let features = FrameFeatures::find(black_box(&current), None);
                let adaptive = match_features(&features.adaptive, &before.adaptive);
                (adaptive, match_features(&features.default, &before.default))
            })
        });
        let now = FrameFeatures::find(&current, None).adaptive;
        let pairs: Vec<RayPair> = match_features(&now, &before.adaptive)
            .iter()
            .map(|pair| {
                let (seen, earlier) = (
                    now.keypoints[pair.current as usize],
                    before.adaptive.keypoints[pair.previous as usize],
                );
                RayPair {
                    previous: ray(earlier.x, earlier.y),
                    current: ray(seen.x, seen.y),
                }
            })
            .collect();
        group.bench_function(format!("pose_{name}"), |b| {
            b.iter(|| {
                estimate_pose(&MatchedRays {
                    pairs: black_box(&pairs),
                    pixel_rad: 1.0 / FOCAL_PX,
                    seed: 1,
                })
            })
        });
    }
    illumination(&mut group);
    group.finish();
}

fn illumination(group: &mut criterion::BenchmarkGroup<criterion::measurement::WallTime>) {
    let lamp = |x: usize, y: usize| 0.1 + (x + y) as f32 / 1400.0;
    let plane = Plane::from_fn(WIDTH, HEIGHT, lamp);
    let reflectance = Plane::from_fn(WIDTH, HEIGHT, |x, y| 0.2 + 0.5 * hash(x / 9, y / 7) as f32);
    let input = Rgb8::from_fn(WIDTH, HEIGHT, |x, y| {
        [(255.0 * (lamp(x, y) * reflectance.pixel(x, y)).sqrt()) as u8; 3]
    });
    let light = TrueLight {
        illumination: &plane,
        reflectance: &reflectance,
        input: &input,
        mask: None,
    };
    let prepared = Illumination::new(&light);
    assert_eq!(prepared.residual(&input), Some(1.0));
    group.bench_function("illumination_prepared", |b| {
        b.iter(|| Illumination::new(black_box(&light)))
    });
    group.bench_function("illumination_residual", |b| {
        b.iter(|| prepared.residual(black_box(&input)))
    });
}

criterion_group!(benches, matching);
criterion_main!(benches);
