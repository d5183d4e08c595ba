//! The sheet of a style: the photos, then four scenes before and after, at alpha 1 and 0.4.

use anyhow::Context;
use cli::exit::Failure;
use cli::sheet::{Tile, sheet};
use imaging::geometry::Intrinsics;
use imaging::{Rgb8, transfer};
use style::net::{Network, Scratch};

/// Seeds of the scenes, which are not used in training.
const SEEDS: [u64; 4] = [3, 8, 14, 21];
const WIDTH: usize = 480;
const HEIGHT: usize = 360;
const TILE_PX: usize = 200;
const ALPHA: f64 = 0.4;

pub(super) fn draw(photos: &[&Rgb8], network: &Network) -> Result<Rgb8, Failure> {
    let tile = |picture: Rgb8, caption: String| Tile {
        picture,
        caption: vec![caption],
    };
    let mut tiles: Vec<Tile> = photos
        .iter()
        .take(SEEDS.len())
        .enumerate()
        .map(|(index, photo): (usize, &&Rgb8)| tile((*photo).clone(), format!("photo {}", index + 1)))
        .collect();
    let (mut before, mut whole, mut part) = (Vec::new(), Vec::new(), Vec::new());
    let mut scratch = Scratch::default();
    for seed in SEEDS {
        let lens = Intrinsics::centered(0.6 * WIDTH as f64, WIDTH, HEIGHT);
        let scene =
            scenes::procedural("structure", seed, WIDTH, HEIGHT, lens).context("cannot render a scene")?;
        let range = scene.range.as_ref();
        let range = range.map(|range| optics::attenuation::faded(range, style::RANGE_SCALE_M));
        let styled = network.apply(
            &transfer::encode_unit(&scene.radiance),
            range.as_ref(),
            &mut scratch,
        );
        let blended = |alpha| transfer::encode_rgb8(&optics::style_blend(&scene.radiance, &styled, alpha)).0;
        before.push(tile(blended(0.0), format!("scene {seed}")));
        whole.push(tile(blended(1.0), "alpha 1".to_owned()));
        part.push(tile(blended(ALPHA), format!("alpha {ALPHA}")));
    }
    // The photos fill the first row.
    let columns = SEEDS.len();
    let empty = || tile(Rgb8::from_fn(1, 1, |_, _| [22, 26, 30]), String::new());
    tiles.resize_with(columns, empty);
    tiles.extend(before.into_iter().chain(whole).chain(part));
    Ok(sheet(&tiles, columns, TILE_PX))
}
