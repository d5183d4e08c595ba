//! Draws docs/pictures/suspended-sheet.png and suspended-sequence.png: one frame without and with what is suspended in the water,
//! and four frames of a sequence. `cargo run --release -p fathom-renderer --example suspended_sheets -- FOLDER`

use std::error::Error;
use std::path::Path;
use std::sync::Arc;

use imaging::codec::{Radiance, decode_radiance, downscale, encode_png};
use imaging::{Raster, Rgb8};
use renderer::{Engine, SceneSource, Slot, vocabulary};
use serde_json::{Value, json};
use spec::Job;
use style::Library;

/// Longer side of a picture on a sheet.
const SIDE: usize = 560;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("where to? name a folder")?;
    let snow = json!({"density_per_m3": 400, "radius_m": 0.0015, "near_m": 0.25, "far_m": 4, "albedo": [0.45, 0.45, 0.42]});
    let patches = json!({"contrast": 0.9, "scale_m": 1.2});
    let day = json!({"optics": "jerlov-1C"});
    let night = json!({"optics": {"preset": "jerlov-1C", "veil_gain": 0.02}, "depth_m": 60, "ambient": "absolute",
                       "snow": snow, "turbidity": patches});
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
    write(&Path::new(&folder).join("suspended-sheet.png"), &pictures)?;
    let mut moving = still;
    moving["path"] = json!({"frames": 90, "sway_m": 0.02});
    let mut water = with("snow", &snow);
    water["turbidity"] = patches;
    let sequence = render(&water, &json!([]), &moving, 4)?;
    write(&Path::new(&folder).join("suspended-sequence.png"), &sequence)
}

fn render(water: &Value, lights: &Value, camera: &Value, count: u64) -> Result<Vec<Rgb8>, Box<dyn Error>> {
    let library = Library::embedded()?;
    let words = vocabulary(&library, false);
    let description = json!({"scene": {"kind": "procedural", "family": "pipeline", "seed": 4}, "seed": 11, "count": count,
                             "camera": camera, "water": water, "lights": lights, "metrics": []});
    let job = Job::parse(description.to_string().as_bytes(), &words)?;
    let mut slot = Slot::new(&Arc::new(Engine::new(library, None)));
    let mut pictures = Vec::new();
    for index in 0..count {
        let rendered = slot.render(&job.resolve(index)?, &SceneSource::Local)?;
        let file = rendered.files.first().ok_or("a frame has a picture")?;
        let Radiance::Encoded(raster) = decode_radiance(&file.bytes)? else {
            return Err("a picture of codes".into());
        };
        pictures.push(downscale(&raster.to_rgb8(), SIDE));
    }
    Ok(pictures)
}

/// Four pictures, two in a row, with a white line between.
fn write(path: &Path, pictures: &[Rgb8]) -> Result<(), Box<dyn Error>> {
    let [first, ..] = pictures else {
        return Err("no picture".into());
    };
    let (width, height) = (first.width(), first.height());
    let sheet = Rgb8::from_fn(2 * width + 4, 2 * height + 4, |x, y| {
        let (column, row) = (x / (width + 2), y / (height + 2));
        let (x, y) = (x % (width + 2), y % (height + 2));
        match pictures.get(2 * row + column) {
            Some(picture) if x < width && y < height => picture.at(x, y),
            _ => [255; 3],
        }
    });
    Ok(std::fs::write(path, encode_png(&Raster::from(sheet))?)?)
}
