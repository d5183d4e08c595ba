//! Times of the camera's stages on a frame of 768×492 on one core.

use std::hint::black_box;

use camera::geometry::{self, Lens, PortRefraction, Sampling, SourcePicture};
use camera::sensor::{self, Chance, FixedPattern};
use camera::vignette::{self, FallOff};
use camera::{balance, defocus, exposure, jpeg, mosaic, preset, tone};
use criterion::{Criterion, criterion_group, criterion_main};
use imaging::geometry::Intrinsics;
use imaging::{Plane, Rgb};
use spec::{Chroma, Distortion, Jpeg, Metering, Tone, Vignette, WhiteBalance};

const WIDTH: usize = 768;
const HEIGHT: usize = 492;

fn picture(width: usize, height: usize, level: f32) -> Rgb<f32> {
    Rgb::from_fn(width, height, |x, y| {
        let wave = 0.5 + 0.4 * (0.05 * x as f32).sin() * (0.03 * y as f32).cos();
        [wave * level, 0.8 * wave * level, 0.6 * wave * level]
    })
}

fn geometry(bench: &mut Criterion) {
    let barrel = Distortion {
        k1: -0.12,
        k2: 0.02,
        ..Distortion::default()
    };
    let sea = [1.3377, 1.3408, 1.3459];
    for (name, index) in [("one index", [1.34; 3]), ("three indices", sea)] {
        let lens = Lens {
            camera: Intrinsics::centered(458.0, WIDTH, HEIGHT),
            distortion: barrel,
            refraction: PortRefraction::Flat { index },
        };
        let source = SourcePicture::covering(&lens, (WIDTH, HEIGHT), 1).expect("a source");
        let scene = picture(source.size.0, source.size.1, 1.0);
        bench.bench_function(&format!("map, {name}"), |b| {
            b.iter(|| {
                Sampling::new(
                    &geometry::coordinates(black_box(&lens), &source, (WIDTH, HEIGHT)),
                    source.size,
                )
            });
        });
        let sampling = Sampling::new(
            &geometry::coordinates(&lens, &source, (WIDTH, HEIGHT)),
            source.size,
        );
        bench.bench_function(&format!("samples, {name}"), |b| {
            b.iter(|| sampling.picture(black_box(&scene)));
        });
    }
}

fn light(bench: &mut Criterion) {
    let scene = picture(WIDTH, HEIGHT, 1.0);
    let radii = |radius: &dyn Fn(usize, usize) -> f64| Plane::from_fn(WIDTH, HEIGHT, radius);
    let noise = |x: usize, y: usize| ((x * 7919 + y * 104_729) % 1013) as f64 / 1013.0;
    for (name, radii) in [
        ("radius 1.7", radii(&|_, _| 1.7)),
        ("radius 5", radii(&|_, _| 5.0)),
        (
            "radii 0 to 5 by row",
            radii(&|_, y| 5.0 * y as f64 / HEIGHT as f64),
        ),
        (
            "radii 0.6 to 2 by column",
            radii(&|x, _| 0.6 + 1.4 * x as f64 / WIDTH as f64),
        ),
        ("radii 0.6 to 3 at random", radii(&|x, y| 0.6 + 2.4 * noise(x, y))),
        ("radii 0 to 16 at random", radii(&|x, y| 16.0 * noise(x, y))),
    ] {
        bench.bench_function(&format!("defocus, {name}"), |b| {
            b.iter(|| defocus::blur(black_box(&scene), &radii));
        });
    }
    let law = Vignette { v: 1.0, v2: -0.1 };
    let falloff = FallOff::new(law, Intrinsics::centered(458.0, WIDTH, HEIGHT), (WIDTH, HEIGHT));
    let mut exposed = scene.clone();
    bench.bench_function("vignette and fixed exposure", |b| {
        b.iter(|| vignette::expose(black_box(&mut exposed), Some(&falloff), 1.0));
    });
    let metering = Metering {
        target: 0.5,
        percentile: 0.95,
        lag_frames: 0.0,
    };
    bench.bench_function("metering", |b| {
        b.iter(|| exposure::metered(black_box(&scene), Some(&falloff), &metering));
    });
}

fn codes(bench: &mut Criterion) {
    let sensor = preset::SENSORS[0].sensor();
    let chance = Chance { seed: 1, frame: 0 };
    bench.bench_function("pattern of a camera", |b| {
        b.iter(|| FixedPattern::new(black_box(&sensor), 1, WIDTH * HEIGHT));
    });
    let pattern = FixedPattern::new(&sensor, 1, WIDTH * HEIGHT);
    let lit = |level| picture(WIDTH, HEIGHT, level);
    let even = |electrons: f64| {
        let light = (electrons / sensor.white_e()) as f32;
        Rgb::from_fn(WIDTH, HEIGHT, |_, _| [light; 3])
    };
    // Pixels alternate irregularly between both sides of the Poisson switch.
    let mixed = Rgb::from_fn(WIDTH, HEIGHT, |x, y| {
        let electrons = 60.0 * ((x * 7919 + y * 104_729) % 1013) as f64 / 1013.0;
        [(electrons / sensor.white_e()) as f32; 3]
    });
    for (name, scene) in [
        ("well lit", lit(1.0)),
        ("few electrons", lit(0.001)),
        ("28 electrons", even(28.0)),
        ("few and many electrons", mixed),
    ] {
        bench.bench_function(&format!("sensor, {name}"), |b| {
            b.iter(|| sensor::read(black_box(&scene), &sensor, chance, &pattern));
        });
    }
    let raw = sensor::read(&picture(WIDTH, HEIGHT, 1.0), &sensor, chance, &pattern);
    bench.bench_function("demosaic", |b| {
        b.iter(|| mosaic::light_of(black_box(&raw), &sensor))
    });
    let light = mosaic::light_of(&raw, &sensor);
    bench.bench_function("gray world", |b| {
        b.iter(|| balance::gains(black_box(&light), WhiteBalance::GrayWorld));
    });
    bench.bench_function("codes by gamma", |b| {
        b.iter(|| tone::codes(black_box(&light), Tone::Gamma(2.2)));
    });
    let (picture, _) = tone::codes(&light, Tone::Srgb);
    for chroma in [Chroma::Full, Chroma::Half] {
        let law = Jpeg { quality: 80, chroma };
        bench.bench_function(&format!("jpeg, {chroma:?}"), |b| {
            b.iter(|| jpeg::compressed(black_box(&picture), law));
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).measurement_time(std::time::Duration::from_secs(1)).warm_up_time(std::time::Duration::from_millis(200));
    targets = geometry, light, codes
}
criterion_main!(benches);
