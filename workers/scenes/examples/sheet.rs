//! Writes a contact sheet of the seeds 0..24 of the family `structure`: `cargo run --release --example sheet -- FILE.png`.

use std::time::Instant;

use fathom_scenes::procedural;
use imaging::geometry::Intrinsics;
use imaging::{Raster, Rgb8, codec, transfer};

/// Frames made of each seed; the fastest counts.
const REPEATS: usize = 7;
const COLUMNS: usize = 6;
const SEEDS: u64 = 24;
const SIZE: (usize, usize) = (768, 492);
const TILE: (usize, usize) = (384, 246);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("name the file to write")?;
    let lens = Intrinsics::centred(458.0, SIZE.0, SIZE.1);
    let mut tiles = Vec::new();
    let mut times = Vec::new();
    for seed in 0..SEEDS {
        let scene = procedural("structure", seed, SIZE.0, SIZE.1, lens)?;
        let mut least = f64::INFINITY;
        for _ in 0..REPEATS {
            let begun = Instant::now();
            std::hint::black_box(procedural("structure", seed, SIZE.0, SIZE.1, lens)?);
            least = least.min(begun.elapsed().as_secs_f64() * 1e3);
        }
        times.push(least);
        tiles.push(codec::downscale(
            &transfer::encode_rgb8(&scene.radiance).0,
            TILE.0,
        ));
    }
    times.sort_by(f64::total_cmp);
    println!(
        "{}x{}: median {:.1} ms, slowest {:.1} ms",
        SIZE.0,
        SIZE.1,
        times[times.len() / 2],
        times[times.len() - 1]
    );
    let rows = tiles.len() / COLUMNS;
    let sheet = Rgb8::from_fn(COLUMNS * TILE.0, rows * TILE.1, |x, y| {
        tiles[y / TILE.1 * COLUMNS + x / TILE.0].at(x % TILE.0, y % TILE.1)
    });
    std::fs::write(path, codec::encode_png(&Raster::from(sheet))?)?;
    Ok(())
}
