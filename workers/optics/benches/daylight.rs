//! Daylight on a picture of 768×492: surfaces, and caustics with the tiles for their lookup.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use imaging::geometry::Intrinsics;
use imaging::{Plane, Rgb};
use optics::daylight::{
    Caustics, Daylight, DaylightModel, Gaze, Reaching, SurfaceLight, Tiles, caustics, shafts, slices,
    surfaces,
};
use optics::lamp::normals_of;
use optics::medium::Medium;
use optics::water::Water;
use spec::Optics;

const SIZE: (usize, usize) = (768, 492);

fn daylight(sun_share: f64) -> Daylight {
    let medium = Medium {
        depth_m: Some(6.0),
        daylight: Some(DaylightModel {
            surfaces: SurfaceLight::Normal,
            sun_share,
            caustics: Some(Caustics {
                tile_m: 3.0,
                cells: 128,
                slope: 0.12,
                wind_deg: 20.0,
                fps: None,
            }),
            ..DaylightModel::default()
        }),
        ..Medium::from(Optics {
            absorption_per_m: Some([0.353, 0.077, 0.066]),
            scattering_per_m: Some([0.164, 0.184, 0.195]),
            ..Optics::default()
        })
    };
    let camera = Intrinsics::centered(460.0, SIZE.0, SIZE.1);
    let water = Water::resolve(&medium, camera.focal_px).expect("a water");
    let water = water.seen_by(Gaze::new(camera, SIZE, [0.0, -0.9, 0.4]));
    *water.daylight().expect("daylight")
}

fn bench(criterion: &mut Criterion) {
    let camera = Intrinsics::centered(460.0, SIZE.0, SIZE.1);
    let range = Plane::from_fn(SIZE.0, SIZE.1, |x, y| 1.0 + 0.004 * (x + 2 * y) as f32);
    let normals = normals_of(&range, &camera);
    let albedo = Rgb::from_fn(SIZE.0, SIZE.1, |x, _| [0.2 + 1e-4 * x as f32; 3]);
    for (name, share) in [("surfaces overcast", 0.0), ("surfaces sunny", 0.6)] {
        let daylight = daylight(share);
        criterion.bench_function(name, |bencher| {
            bencher.iter(|| {
                black_box(surfaces(
                    &albedo,
                    &range,
                    &normals,
                    &daylight,
                    Reaching::default(),
                ))
            });
        });
    }
    let daylight = daylight(0.6);
    let (waves, blur) = daylight.waves(1, 0).expect("waves");
    let (shallowest, deepest) = daylight.depths_m(&range).expect("surfaces");
    let depths = slices(shallowest, deepest);
    criterion.bench_function("caustics: tiles", |bencher| {
        bencher.iter(|| black_box(Tiles::new(&waves, &blur, depths.clone())));
    });
    let tiles = Tiles::new(&waves, &blur, depths);
    let sun = daylight.sun().expect("a sun");
    criterion.bench_function("caustics: look-up", |bencher| {
        let mut light = Plane::filled(SIZE.0, SIZE.1, 1.0f32);
        bencher.iter(|| caustics(&range, &daylight, sun, &tiles, black_box(&mut light)));
    });
    criterion.bench_function("shafts", |bencher| {
        bencher.iter(|| black_box(shafts(&range, &daylight, sun, &tiles, 0.26)));
    });
}

criterion_group!(benches, bench);
criterion_main!(benches);
