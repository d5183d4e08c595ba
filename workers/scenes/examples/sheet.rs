//! Writes a contact sheet of a family: `cargo run --release --example sheet -- FILE.png FAMILY [TILE_WIDTH] [SEED…]`.

use std::time::Instant;

use imaging::geometry::Intrinsics;
use imaging::{Raster, Rgb8, codec, transfer};
use scenes::procedural;

/// Frames made of each seed; the fastest counts.
const REPEATS: usize = 5;
const COLUMNS: usize = 6;
const SIZE: (usize, usize) = (768, 492);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("name the file to write")?;
    let family = arguments.next().ok_or("name the family")?;
    let tile_width = arguments.next().map_or(Ok(256), |width| width.parse())?;
    let mut seeds = arguments
        .map(|seed| seed.parse())
        .collect::<Result<Vec<u64>, _>>()?;
    if seeds.is_empty() {
        seeds = (0..24).collect();
    }
    let lens = Intrinsics::centred(458.0, SIZE.0, SIZE.1);
    let mut tiles = Vec::new();
    let mut times = Vec::new();
    for seed in seeds {
        let scene = procedural(&family, seed, SIZE.0, SIZE.1, lens)?;
        let mut least = f64::INFINITY;
        for _ in 0..REPEATS {
            let begun = Instant::now();
            std::hint::black_box(procedural(&family, seed, SIZE.0, SIZE.1, lens)?);
            least = least.min(begun.elapsed().as_secs_f64() * 1e3);
        }
        times.push(least);
        tiles.push(codec::downscale(
            &transfer::encode_rgb8(&scene.radiance).0,
            tile_width,
        ));
    }
    times.sort_by(f64::total_cmp);
    println!(
        "{family} {}x{}, best of {REPEATS}: fastest {:.1} ms, median {:.1} ms, slowest {:.1} ms",
        SIZE.0,
        SIZE.1,
        times[0],
        times[times.len() / 2],
        times[times.len() - 1]
    );
    let (width, height) = (tiles[0].width(), tiles[0].height());
    let columns = COLUMNS.min(tiles.len());
    let rows = tiles.len().div_ceil(columns);
    let sheet = Rgb8::from_fn(columns * width, rows * height, |x, y| {
        tiles
            .get(y / height * columns + x / width)
            .map_or([0; 3], |tile| tile.at(x % width, y % height))
    });
    std::fs::write(path, codec::encode_png(&Raster::from(sheet))?)?;
    Ok(())
}
