//! `fathom-lab effect-sheets`: scenes without and with each effect, beside each other.

use std::path::PathBuf;

use cli::exit::Failure;
use cli::files;
use cli::progress::Progress;
use cli::sheet::{Tile, sheet};
use lab::effects::{Effect, effects};
use scenes::FAMILIES;
use serde_json::json;

use crate::studio::{Studio, raster};

/// Options of `fathom-lab effect-sheets`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Scenes of each sheet, one of each family by turns
    #[arg(long, default_value_t = 12, value_parser = clap::value_parser!(u64).range(1..=100))]
    scenes: u64,
    /// Columns of each picture
    #[arg(long, default_value_t = 200)]
    tile_width: usize,
    /// Folder for a sheet (.jpg) of each effect
    #[arg(long, value_name = "DIR", default_value = "docs/pictures")]
    out: PathBuf,
}

const SIZE: (usize, usize) = (400, 256);
/// Pictures side by side: pairs without and with.
const COLUMNS: usize = 6;

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut studio = Studio::with_shipped_styles()?;
    let all = effects();
    let mut progress = Progress::new("effect-sheets", "sheets", all.len() as u64);
    for (number, effect) in all.iter().enumerate() {
        let mut tiles = Vec::new();
        for scene in 0..arguments.scenes {
            for with in [false, true] {
                tiles.push(tile(&mut studio, effect, scene, with)?);
            }
        }
        let name = format!("effect-{}.jpg", effect.name.replace(' ', "-"));
        let sheet = sheet(&tiles, COLUMNS, arguments.tile_width);
        files::write_picture(&arguments.out.join(name), &sheet.into())?;
        progress.set(number as u64 + 1);
    }
    progress.finish();
    Ok(())
}

fn tile(studio: &mut Studio, effect: &Effect, scene: u64, with: bool) -> Result<Tile, Failure> {
    let family = FAMILIES[scene as usize % FAMILIES.len()];
    let mut job = effect.job(with, SIZE);
    job["scene"]["family"] = json!(family);
    job["scene"]["seed"] = json!(scene + 1);
    let frame = studio.frame(&job, 0)?;
    let picture = raster(&studio.render(&frame)?, "rgb")?.to_rgb8();
    let state = if with { "on" } else { "off" };
    Ok(Tile {
        picture,
        caption: vec![format!("{family}:{} {state}", scene + 1)],
    })
}
