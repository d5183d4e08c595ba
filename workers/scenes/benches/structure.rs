//! One frame of the family `structure` on one core.

use criterion::{Criterion, criterion_group, criterion_main};
use fathom_scenes::procedural;
use imaging::geometry::Intrinsics;

fn structure(c: &mut Criterion) {
    let lens = Intrinsics::centred(458.0, 768, 492);
    let mut seed = 0;
    c.bench_function("structure 768x492", |b| {
        b.iter(|| {
            seed = (seed + 1) % 24;
            procedural("structure", seed, 768, 492, lens)
        });
    });
}

criterion_group!(benches, structure);
criterion_main!(benches);
