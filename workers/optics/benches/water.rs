//! Times of the water stages for one frame of 768×492 on one core.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use imaging::dct::PairDct;
use imaging::fft::Complex;
use imaging::{Plane, Rgb};
use optics::forward_scatter::KernelCache;
use optics::kernel::Transfer;
use optics::medium::{Kernels, Medium};
use optics::plan::{Plan, SceneBounds};
use optics::water::Water;
use optics::{chain, haze};
use spec::{Fidelity, Haze, HazeBlend, HazeSpace, Optics, ScatterModel};

const WIDTH: usize = 768;
const HEIGHT: usize = 492;

fn radiance() -> Rgb<f32> {
    Rgb::from_fn(WIDTH, HEIGHT, |x, y| {
        let stripe = if (x / 37 + y / 23) % 2 == 0 { 0.8 } else { 0.1 };
        [stripe, 0.7 * stripe, 0.9 - stripe]
    })
}

/// A slope with a near pole: a different range in every pixel.
fn range(near_m: f32, far_m: f32) -> Plane<f32> {
    Plane::from_fn(WIDTH, HEIGHT, |x, y| {
        let slope = near_m + (far_m - near_m) * (y as f32 + x as f32 / WIDTH as f32) / HEIGHT as f32;
        if (300..340).contains(&x) {
            1.5 + 1e-3 * y as f32
        } else {
            slope
        }
    })
}

fn water_of(preset: &str, model: ScatterModel) -> Water {
    resolve(&medium_of(preset, model))
}

fn medium_of(preset: &str, model: ScatterModel) -> Medium {
    Medium::from(Optics {
        preset: Some(preset.to_owned()),
        forward_scatter: Some(model.into()),
        ..Optics::default()
    })
}

fn resolve(medium: &Medium) -> Water {
    Water::resolve(medium, 600.0).expect("a renderable preset")
}

fn water(bench: &mut Criterion) {
    let (radiance, coastal) = (radiance(), range(1.0, 15.0));
    let mut cache = KernelCache::new();
    let mut stage = |name: &str, water: Water, range: &Plane<f32>, fidelity: Fidelity| {
        let stats = SceneBounds::measure(&radiance, range, &water);
        let plan = Plan::for_water(&stats, &water, fidelity);
        bench.bench_function(name, |b| {
            b.iter(|| {
                let layers = chain::water(black_box(&radiance), range, &water, &plan, &mut cache);
                cache.recycle(layers.expect("a good frame"));
            });
        });
    };
    let of = |model| water_of("jerlov-1C", model);
    let bounded = Fidelity::Tolerance(3e-4);
    stage("attenuation", of(ScatterModel::None), &coastal, bounded);
    for terms in [4, 6, 9] {
        let fixed = Fidelity::Terms(terms);
        stage(
            &format!("jaffe K={terms}"),
            of(ScatterModel::Jaffe),
            &coastal,
            fixed,
        );
    }
    for (name, kernels, layers) in [
        ("one kernel", Kernels::One, None),
        ("two kernels", Kernels::Two, None),
        ("two layers", Kernels::Two, Some(2)),
        ("three layers", Kernels::Two, Some(3)),
    ] {
        let water = resolve(&Medium {
            kernels,
            layers,
            ..medium_of("jerlov-1C", ScatterModel::Jaffe)
        });
        stage(
            &format!("{name} K=8"),
            water.clone(),
            &coastal,
            Fidelity::Terms(8),
        );
        stage(&format!("{name} within 3e-4"), water, &coastal, bounded);
    }
    let simplified = of(ScatterModel::Simplified);
    stage("simplified K=4", simplified, &coastal, Fidelity::Terms(4));
    let turbid = water_of("jerlov-5C", ScatterModel::Jaffe);
    stage(
        "jaffe within 3e-4, jerlov-5C over 0.5 to 10 m",
        turbid,
        &range(0.5, 10.0),
        bounded,
    );
    let water = of(ScatterModel::Jaffe);
    bench.bench_function("scene stats", |b| {
        b.iter(|| SceneBounds::measure(black_box(&radiance), &coastal, &water))
    });
}

fn parts(bench: &mut Criterion) {
    let mut transform = PairDct::new(WIDTH, HEIGHT);
    let radiance_planes = radiance();
    let samples = radiance_planes.planes()[0].data();
    let mut sum = vec![Complex::default(); samples.len()];
    bench.bench_function("DCT of two planes, there and back", |b| {
        b.iter(|| {
            transform.forward(
                |y, row| {
                    for (value, &v) in row.iter_mut().zip(&samples[y * WIDTH..]) {
                        *value = Complex::new(v, 1.0 - v);
                    }
                },
                WIDTH,
                |p, column| sum[p * HEIGHT..][..HEIGHT].copy_from_slice(column),
            );
            transform.inverse(
                |p, column| column.copy_from_slice(&sum[p * HEIGHT..][..HEIGHT]),
                WIDTH,
                |_, row| {
                    black_box(row);
                },
            );
        });
    });
    bench.bench_function("transfer function of a new node", |b| {
        b.iter(|| Transfer::new(black_box(2.5)).grid_f32(WIDTH, HEIGHT));
    });
    let light = |x| Haze {
        x,
        y: 1.0,
        size: 0.2,
        intensity: 0.8,
        color: [1.0, 0.9, 0.7],
        blend: HazeBlend::Over,
        space: HazeSpace::Linear,
    };
    let lights = [0.0, 0.3, 0.6, 1.0].map(light);
    bench.bench_function("haze of four lights", |b| {
        b.iter_batched(
            radiance,
            |image| haze(image, &lights),
            criterion::BatchSize::LargeInput,
        );
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).measurement_time(std::time::Duration::from_secs(2)).warm_up_time(std::time::Duration::from_millis(500));
    targets = water, parts
}
criterion_main!(benches);
