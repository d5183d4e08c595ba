//! `fathom-lab scenes`: many seeds of a family, or the labels of every family.

use std::path::PathBuf;
use std::time::Instant;

use cli::colors;
use cli::exit::Failure;
use cli::files;
use imaging::geometry::Intrinsics;
use imaging::{Rgb8, codec, transfer};
use scenes::{FAMILIES, World, procedural};

/// Options of `fathom-lab scenes`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// A family; without it a row for each: picture, normals, categories, instances and findings
    family: Option<String>,
    /// Where to write the sheet
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Columns of each picture
    #[arg(long, default_value_t = 256)]
    tile_width: usize,
    /// Seeds, comma-separated [default: 0 to 23 of a family, 2 for the labels]
    #[arg(long, value_delimiter = ',')]
    seeds: Vec<u64>,
}

/// Frames rendered for each seed; the fastest counts.
const REPEATS: usize = 5;
const COLUMNS: usize = 6;
const SIZE: (usize, usize) = (768, 492);

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (tiles, columns) = match &arguments.family {
        Some(family) => (family_tiles(family, arguments)?, COLUMNS),
        None => (label_tiles(arguments)?, 5),
    };
    let (width, height) = (tiles[0].width(), tiles[0].height());
    let columns = columns.min(tiles.len());
    let rows = tiles.len().div_ceil(columns);
    let sheet = Rgb8::from_fn(columns * width, rows * height, |x, y| {
        tiles
            .get(y / height * columns + x / width)
            .map_or([0; 3], |tile| tile.pixel(x % width, y % height))
    });
    files::write_picture(&arguments.out, &sheet.into())
}

fn family_tiles(family: &str, arguments: &Arguments) -> Result<Vec<Rgb8>, Failure> {
    let seeds = match arguments.seeds.as_slice() {
        [] => (0..24).collect(),
        seeds => seeds.to_vec(),
    };
    let lens = Intrinsics::centered(458.0, SIZE.0, SIZE.1);
    let draw = |seed| procedural(family, seed, SIZE.0, SIZE.1, lens).map_err(Failure::input);
    let mut tiles = Vec::new();
    let mut times = Vec::new();
    for seed in seeds {
        let scene = draw(seed)?;
        let mut least = f64::INFINITY;
        for _ in 0..REPEATS {
            let begun = Instant::now();
            std::hint::black_box(draw(seed)?);
            least = least.min(begun.elapsed().as_secs_f64() * 1e3);
        }
        times.push(least);
        tiles.push(codec::downscale(
            &transfer::encode_rgb8(&scene.radiance).0,
            arguments.tile_width,
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
    Ok(tiles)
}

fn label_tiles(arguments: &Arguments) -> Result<Vec<Rgb8>, Failure> {
    let seed = arguments.seeds.first().copied().unwrap_or(2);
    let lens = Intrinsics::centered(458.0, SIZE.0, SIZE.1);
    let mut tiles = Vec::new();
    for family in FAMILIES {
        let world = World::new(family, seed).map_err(Failure::input)?;
        let (scene, labels) = world.render_labeled(&world.pose(), SIZE, &lens);
        let picture = transfer::encode_rgb8(&scene.radiance).0;
        let instances = scene.instances.expect("procedural scenes have instances");
        let surfaces = labels.surfaces.expect("procedural scenes have surfaces");
        let part = |v: f32| ((0.5 + 0.5 * v) * 255.0) as u8;
        let views = [
            Rgb8::from_fn(SIZE.0, SIZE.1, |x, y| {
                [0, 1, 2].map(|axis| part(surfaces.normals[axis].pixel(x, y)))
            }),
            Rgb8::from_fn(SIZE.0, SIZE.1, |x, y| {
                colors::category(labels.semantics.pixel(x, y))
            }),
            Rgb8::from_fn(SIZE.0, SIZE.1, |x, y| colors::instance(instances.pixel(x, y))),
            Rgb8::from_fn(SIZE.0, SIZE.1, |x, y| {
                let found = colors::finding(surfaces.findings.pixel(x, y));
                found.unwrap_or_else(|| picture.pixel(x, y).map(|v| v / 2))
            }),
        ];
        tiles.push(codec::downscale(&picture, arguments.tile_width));
        tiles.extend(
            views
                .iter()
                .map(|view| codec::downscale(view, arguments.tile_width)),
        );
    }
    Ok(tiles)
}
