//! Times of four lamps over a frame of 768×492 on one core.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use imaging::geometry::Intrinsics;
use imaging::{Plane, Rgb};
use optics::lamp::{self, GlowPhase, LAMP_RADIUS_M, Lamp, Lighting};
use optics::snow::World;
use optics::turbidity::Field;
use spec::Turbidity;

const WIDTH: usize = 768;
const HEIGHT: usize = 492;

fn lighting(lamps: Vec<Lamp>) -> Lighting {
    Lighting {
        lamps,
        radius_m: LAMP_RADIUS_M,
        camera: Intrinsics::centered(458.0, WIDTH, HEIGHT),
        attenuation: [0.778, 0.546, 0.594],
        scattering: [0.412, 0.447, 0.435],
        absorption: None,
        phase: GlowPhase::henyey_greenstein(0.919),
        patches: None,
    }
}

fn patches() -> Field {
    let turbidity = Turbidity {
        contrast: 0.8,
        scale_m: 1.2,
    };
    Field::new(&turbidity, World { seed: 7, index: 0 })
}

fn lamps(bench: &mut Criterion) {
    let light = [2.0; 3];
    let place = |x: f64, y: f64| [0.4 * x, 0.25 * y, 0.0];
    let corners = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];
    let points: Vec<Lamp> = corners
        .iter()
        .map(|c| Lamp::point(place(c[0], c[1]), light).expect("a lamp"))
        .collect();
    let spots: Vec<Lamp> = corners
        .iter()
        .map(|c| Lamp::spot(place(c[0], c[1]), light, [-0.1 * c[0], 0.0, 1.0], 35.0).expect("a lamp"))
        .collect();
    let in_view: Vec<Lamp> = corners
        .iter()
        .map(|c| Lamp::point([0.5 * c[0], 0.3 * c[1], 1.5], [0.05; 3]).expect("a lamp"))
        .collect();
    let range = Plane::from_fn(WIDTH, HEIGHT, |x, y| {
        let slope = 1.0 + 14.0 * (y as f32 + x as f32 / WIDTH as f32) / HEIGHT as f32;
        if (300..340).contains(&x) {
            1.5 + 1e-3 * y as f32
        } else {
            slope
        }
    });
    for (name, lamps) in [("points", points), ("spots", spots), ("in view", in_view)] {
        let lighting = lighting(lamps);
        for tolerance in [3e-4, 1e-5] {
            bench.bench_function(&format!("airlight of 4 {name}, tolerance {tolerance:e}"), |b| {
                b.iter(|| lamp::airlight(black_box(&range), &lighting, tolerance));
            });
        }
        // All that a frame with lamps costs more than one without.
        let scene = Rgb::from_fn(WIDTH, HEIGHT, |_, _| [0.5f32; 3]);
        bench.bench_function(
            &format!("4 {name}: normals, lit surfaces and airlight, tolerance 3e-4"),
            |b| {
                b.iter(|| {
                    let normals = lamp::normals_of(black_box(&range), &lighting.camera);
                    let surfaces = lamp::irradiance(&range, &normals, &lighting);
                    let lit = lamp::lit(&scene, [0.2; 3], &surfaces.light);
                    (lit, lamp::airlight(&range, &lighting, 3e-4))
                });
            },
        );
        let patchy = Lighting {
            patches: Some(patches()),
            ..lighting.clone()
        };
        bench.bench_function(
            &format!("4 {name} in patches: normals, surfaces and airlight"),
            |b| {
                b.iter(|| {
                    let normals = lamp::normals_of(black_box(&range), &patchy.camera);
                    let surfaces = lamp::irradiance(&range, &normals, &patchy);
                    (surfaces, lamp::airlight(&range, &patchy, 3e-4))
                });
            },
        );
        let joined = |lighting: &Lighting| Lighting {
            absorption: Some([0.366, 0.099, 0.159]),
            ..lighting.clone()
        };
        for (water, lighting) in [("", joined(&lighting)), (" in patches", joined(&patchy))] {
            let normals = lamp::normals_of(&range, &lighting.camera);
            bench.bench_function(&format!("airlight of 4 {name}{water}, multiply scattered"), |b| {
                b.iter(|| lamp::airlight(black_box(&range), &lighting, 3e-4));
            });
            bench.bench_function(
                &format!("light of 4 {name} on surfaces{water}, multiply scattered"),
                |b| {
                    b.iter(|| lamp::irradiance(black_box(&range), &normals, &lighting));
                },
            );
        }
        let normals = lamp::normals_of(&range, &lighting.camera);
        bench.bench_function(&format!("light of 4 {name} on surfaces"), |b| {
            b.iter(|| lamp::irradiance(black_box(&range), &normals, &lighting));
        });
    }
    let camera = Intrinsics::centered(458.0, WIDTH, HEIGHT);
    bench.bench_function("normals", |b| {
        b.iter(|| lamp::normals_of(black_box(&range), &camera))
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).measurement_time(std::time::Duration::from_secs(2)).warm_up_time(std::time::Duration::from_millis(300));
    targets = lamps
}
criterion_main!(benches);
