//! Times of snow and turbidity over a frame of 768×492 on one core.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use imaging::geometry::Intrinsics;
use imaging::{Plane, Rgb};
use optics::eye::Eye;
use optics::snow::{Seeing, Surround, World, flakes, lit, snow};
use optics::turbidity::{Field, optical_path};
use spec::{HoleRule, Snow, Turbidity};

const SIZE: (usize, usize) = (768, 492);
const WORLD: World = World { seed: 1, index: 0 };

fn suspended(bench: &mut Criterion) {
    let eye = Eye::at_origin(Intrinsics::centered(458.0, SIZE.0, SIZE.1));
    let range = Plane::from_fn(SIZE.0, SIZE.1, |x, y| {
        let slope = 1.0 + 14.0 * (y as f32 + x as f32 / SIZE.0 as f32) / SIZE.1 as f32;
        if (300..340).contains(&x) { 1.5 } else { slope }
    });
    let patches = Turbidity {
        contrast: 0.8,
        scale_m: 1.0,
    };
    let field = Field::new(&patches, WORLD);
    bench.bench_function("paths through patches", |b| {
        b.iter(|| optical_path(black_box(&range), &field, &eye, HoleRule::Background));
    });
    let image = Rgb::from_fn(SIZE.0, SIZE.1, |_, _| [0.1f32, 0.2, 0.3]);
    for density in [50.0, 500.0, 5000.0] {
        let law = Snow {
            density_per_m3: density,
            near_m: 0.2,
            far_m: 3.0,
            radius_m: 8e-4,
            albedo: [0.5; 3],
            ..Snow::with_density(0.0)
        };
        let surround = Surround {
            range: &range,
            eye: &eye,
            attenuation: [0.5, 0.2, 0.2],
            path: &|_, meters| meters,
            light: &|places| vec![[1.0; 3]; places.len()],
        };
        let count = flakes(&eye, &law, WORLD, SIZE, &Seeing::STILL).len();
        bench.bench_function(
            &format!("snow, {density} particles per m³, {count} in view"),
            |b| {
                b.iter(|| {
                    let found = flakes(&eye, black_box(&law), WORLD, SIZE, &Seeing::STILL);
                    let found = lit(&found, law.albedo, &surround);
                    let mut image = image.clone();
                    snow(&mut image, &found, &range, 3.75e-5)
                });
            },
        );
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).measurement_time(std::time::Duration::from_secs(2)).warm_up_time(std::time::Duration::from_millis(300));
    targets = suspended
}
criterion_main!(benches);
