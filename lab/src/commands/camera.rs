//! `fathom-lab camera`: one frame with several cameras.

use std::path::PathBuf;

use cli::exit::Failure;
use cli::files;
use imaging::Rgb8;
use imaging::codec::downscale;
use serde_json::{Value, json};

use crate::studio::{Studio, raster};

/// Options of `fathom-lab camera`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Folder for camera-sheet.png
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// Longer side of a picture on the sheet.
const SIDE: usize = 400;
/// Pictures per row.
const COLUMNS: usize = 3;

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let cameras = [
        json!({}),
        json!({"port": {"kind": "flat"}}),
        json!({"distortion": {"k1": -0.14, "k2": 0.02}, "vignette": {}}),
        json!({"defocus": {"aperture_m": 0.03, "focus_m": 1.2}}),
        json!({"exposure_s": 0.25}),
        json!({"sensor": {"preset": "small-pixel-1/2.3", "light_level": 0.004, "gain": 8}, "white_balance": "gray_world"}),
    ];
    let mut pictures = Vec::new();
    for parts in cameras {
        pictures.push(render(&parts)?);
    }
    files::write_picture(&arguments.out.join("camera-sheet.png"), &sheet(&pictures).into())
}

fn render(parts: &Value) -> Result<Rgb8, Failure> {
    let mut camera =
        json!({"width": 768, "height": 492, "hfov_deg": 80, "path": {"frames": 60, "frame": 20}});
    for (name, value) in parts.as_object().into_iter().flatten() {
        camera[name] = value.clone();
    }
    let description = json!({"scene": {"kind": "procedural", "family": "structure", "seed": 7}, "seed": 11,
                             "camera": camera, "water": {"optics": "jerlov-IB"}, "metrics": []});
    let mut studio = Studio::with_shipped_styles()?;
    let frame = studio.frame(&description, 0)?;
    let picture = raster(&studio.render(&frame)?, "rgb")?;
    Ok(downscale(&picture.to_rgb8(), SIDE))
}

/// Arranges pictures row by row, separated by white lines.
fn sheet(pictures: &[Rgb8]) -> Rgb8 {
    let (width, height) = (pictures[0].width(), pictures[0].height());
    let rows = pictures.len().div_ceil(COLUMNS);
    Rgb8::from_fn(COLUMNS * (width + 2), rows * (height + 2), |x, y| {
        let (column, row) = (x / (width + 2), y / (height + 2));
        let (x, y) = (x % (width + 2), y % (height + 2));
        match pictures.get(COLUMNS * row + column) {
            Some(picture) if x < width && y < height => picture.pixel(x, y),
            _ => [255; 3],
        }
    })
}
