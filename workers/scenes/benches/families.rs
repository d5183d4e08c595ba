//! Time of one frame of every family on one core, without and with labels.

use criterion::{Criterion, criterion_group, criterion_main};
use imaging::geometry::Intrinsics;
use scenes::{FAMILIES, World, procedural};

const SIZE: (usize, usize) = (768, 492);
const SEEDS: u64 = 24;

fn frames(c: &mut Criterion) {
    let lens = Intrinsics::centered(458.0, SIZE.0, SIZE.1);
    for family in FAMILIES {
        let mut seed = 0;
        c.bench_function(&format!("{family} 768x492"), |b| {
            b.iter(|| {
                seed = (seed + 1) % SEEDS;
                procedural(family, seed, SIZE.0, SIZE.1, lens)
            });
        });
        c.bench_function(&format!("{family} 768x492 with labels"), |b| {
            b.iter(|| {
                seed = (seed + 1) % SEEDS;
                World::new(family, seed).map(|world| world.render_labeled(&world.pose(), SIZE, &lens))
            });
        });
    }
}

criterion_group!(benches, frames);
criterion_main!(benches);
