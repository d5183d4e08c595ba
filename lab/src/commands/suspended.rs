//! `fathom-lab suspended`: one frame with and without suspended matter, and four frames of a sequence.

use std::path::PathBuf;

use cli::exit::Failure;
use cli::files;
use imaging::Rgb8;
use imaging::codec::downscale;
use serde_json::{Value, json};

use crate::studio::{Studio, raster};

/// Options of `fathom-lab suspended`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Folder for suspended-sheet.png and suspended-sequence.png
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// Longer side of a picture on a sheet.
const SIDE: usize = 560;

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let snow = json!({"density_per_m3": 400, "radius_m": 0.0015, "near_m": 0.25, "far_m": 4, "albedo": [0.45, 0.45, 0.42]});
    let patches = json!({"contrast": 0.9, "scale_m": 1.2});
    let day = json!({"optics": "jerlov-1C"});
    let night = json!({"optics": "jerlov-1C", "snow": snow, "turbidity": patches});
    let spot = |side: f64| {
        json!({"kind": "spot", "position_m": [0.45 * side, -0.25, 0.0], "intensity": [25, 25, 25],
               "direction": [-0.12 * side, 0.1, 1.0], "cone_deg": 50})
    };
    let with = |name: &str, value: &Value| {
        let mut water = day.clone();
        water[name] = value.clone();
        water
    };
    let frames = [
        (day.clone(), json!([])),
        (with("snow", &snow), json!([])),
        (with("turbidity", &patches), json!([])),
        (night, json!([spot(-1.0), spot(1.0)])),
    ];
    let still = json!({"width": 768, "height": 492, "hfov_deg": 80});
    let mut pictures = Vec::new();
    for (water, lights) in frames {
        pictures.extend(render(&water, &lights, &still, 1)?);
    }
    files::write_picture(
        &arguments.out.join("suspended-sheet.png"),
        &four(&pictures).into(),
    )?;
    let mut moving = still;
    moving["path"] = json!({"frames": 90, "sway_m": 0.02});
    let mut water = with("snow", &snow);
    water["turbidity"] = patches;
    let sequence = render(&water, &json!([]), &moving, 4)?;
    files::write_picture(
        &arguments.out.join("suspended-sequence.png"),
        &four(&sequence).into(),
    )
}

fn render(water: &Value, lights: &Value, camera: &Value, count: u64) -> Result<Vec<Rgb8>, Failure> {
    let mut studio = Studio::with_shipped_styles()?;
    let description = json!({"scene": {"kind": "procedural", "family": "pipeline", "seed": 4}, "seed": 11, "count": count,
                             "camera": camera, "water": water, "lights": lights, "metrics": []});
    let picture = |index| {
        let frame = studio.frame(&description, index)?;
        let picture = raster(&studio.render(&frame)?, "rgb")?;
        Ok(downscale(&picture.to_rgb8(), SIDE))
    };
    (0..count).map(picture).collect()
}

/// Four pictures, two per row, separated by white lines.
fn four(pictures: &[Rgb8]) -> Rgb8 {
    let (width, height) = (pictures[0].width(), pictures[0].height());
    Rgb8::from_fn(2 * width + 4, 2 * height + 4, |x, y| {
        let (column, row) = (x / (width + 2), y / (height + 2));
        let (x, y) = (x % (width + 2), y % (height + 2));
        match pictures.get(2 * row + column) {
            Some(picture) if x < width && y < height => picture.pixel(x, y),
            _ => [255; 3],
        }
    })
}
