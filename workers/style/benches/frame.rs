//! One frame through a network on one core.

use criterion::{Criterion, criterion_group, criterion_main};
use imaging::{Plane, Rgb};
use style::net::layer::{PARAMETERS, RANGE_PARAMETERS, Weights};
use style::net::{ColorTable, Network, Scratch, TableScratch};

fn frames(c: &mut Criterion) {
    let network = |parameters: usize| {
        let values = (0..parameters).map(|i| (i as f32 * 0.37).fract() * 0.2 - 0.1);
        Network::new(&Weights::new(values.collect()).expect("as many numbers as it has"))
    };
    let (network, ranged) = (network(PARAMETERS), network(RANGE_PARAMETERS));
    let mut scratch = Scratch::default();
    let table = ColorTable::new(&network).expect("a table of a network without range");
    let mut table_scratch = TableScratch::default();
    for (width, height) in [(640, 480), (869, 565), (1920, 1080)] {
        let frame = Rgb::from_fn(width, height, |x, y| {
            [x as f32 / 1920.0, y as f32 / 1080.0, (x * y % 97) as f32 / 97.0]
        });
        c.bench_function(&format!("net {width}x{height}"), |b| {
            b.iter(|| network.apply(&frame, None, &mut scratch));
        });
        let range = Plane::from_fn(width, height, |x, y| (x + y) as f32 / 3000.0);
        c.bench_function(&format!("net with range {width}x{height}"), |b| {
            b.iter(|| ranged.apply(&frame, Some(&range), &mut scratch));
        });
        c.bench_function(&format!("lut {width}x{height}"), |b| {
            b.iter(|| table.apply(&frame, &mut table_scratch));
        });
    }
}

criterion_group!(benches, frames);
criterion_main!(benches);
