//! `fathom-lab look`: how near the frames of jobs are to what photographs under water look like.

use std::path::PathBuf;

use anyhow::Context;
use cli::exit::Failure;
use cli::files;
use imaging::codec::downscale;
use imaging::{Plane, Rgb8, Samples};
use serde_json::{Value, json};

use crate::look::Look;
use crate::studio::{Studio, raster};

/// Options of `fathom-lab look`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Job descriptions
    #[arg(required = true)]
    jobs: Vec<PathBuf>,
    /// Frames of each job [default: all]
    #[arg(long)]
    frames: Option<u64>,
    /// Where to write a sheet, a row for each job
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Longer side of a picture on the sheet
    #[arg(long, default_value_t = 400)]
    tile_width: usize,
}

/// Pictures of a row of the sheet.
const COLUMNS: usize = 3;

/// A statistic, what photographs have of it, and for which frames that is said.
struct Row {
    name: &'static str,
    of: fn(&Look) -> Option<f64>,
    range: [f64; 2],
    applies: fn(&Value) -> bool,
}

const ROWS: [Row; 6] = [
    Row {
        name: "lightness within open water, spread of L*",
        of: |look| look.spread,
        range: [3.0, 8.0],
        applies: |_| true,
    },
    Row {
        name: "top minus bottom, L*, in daylight",
        of: |look| Some(look.fall),
        range: [5.0, 25.0],
        applies: |job| job.pointer("/water/from_above").is_some(),
    },
    Row {
        name: "clipped, %, with lamps",
        of: |look| Some(look.clipped),
        range: [0.05, 4.0],
        applies: |job| job.get("lights").is_some(),
    },
    Row {
        name: "entropy, bit",
        of: |look| Some(look.entropy),
        range: [5.6, 6.9],
        applies: |_| true,
    },
    Row {
        name: "slope of the spectrum",
        of: |look| Some(look.slope),
        range: [-3.2, -2.6],
        applies: |_| true,
    },
    Row {
        name: "grain of flat areas, codes",
        of: |look| Some(look.grain),
        range: [0.4, 1.2],
        applies: |_| true,
    },
];

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut studio = Studio::with_shipped_styles()?;
    let mut tiles = Vec::new();
    let mut all: Vec<Vec<f64>> = vec![Vec::new(); ROWS.len()];
    for path in &arguments.jobs {
        let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
        let mut job: Value = serde_json::from_str(&text).with_context(|| path.display().to_string())?;
        job["artifacts"] = json!(["rgb", "semantics"]);
        let frames = arguments.frames.or(job["count"].as_u64()).unwrap_or(1);
        let mut looks = Vec::new();
        for index in 0..frames {
            let frame = studio.frame(&job, index)?;
            let rendered = studio.render(&frame)?;
            let picture = raster(&rendered, "rgb")?.to_rgb8();
            let mask = raster(&rendered, "semantics")?;
            let Samples::U8(codes) = mask.samples().clone() else {
                return Err(anyhow::anyhow!("semantics of 16 bits").into());
            };
            let mask = Plane::new(picture.width(), picture.height(), codes).map_err(anyhow::Error::from)?;
            looks.push(Look::of(&picture, &mask));
            if index < COLUMNS as u64 {
                tiles.push(downscale(&picture, arguments.tile_width));
            }
        }
        println!("{}, {frames} frames", path.display());
        for (row, all) in ROWS.iter().zip(&mut all).filter(|(row, _)| (row.applies)(&job)) {
            let values: Vec<f64> = looks.iter().filter_map(row.of).collect();
            print(row, &values);
            all.extend(values);
        }
    }
    println!("all");
    for (row, values) in ROWS.iter().zip(&all) {
        print(row, values);
    }
    match &arguments.out {
        Some(path) => files::write_picture(path, &sheet(&tiles).into()),
        None => Ok(()),
    }
}

/// Median, 10th and 90th percentile, and how many are as in photographs.
fn print(row: &Row, values: &[f64]) {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| {
        let last = sorted.len().saturating_sub(1) as f64;
        sorted
            .get((share * last).round() as usize)
            .copied()
            .unwrap_or(f64::NAN)
    };
    let [low, high] = row.range;
    let within = sorted.iter().filter(|v| (low..=high).contains(v)).count();
    println!(
        "  {:<44} {:>7.2} ({:.2} to {:.2}), wanted {low} to {high}: {within} of {}",
        row.name,
        at(0.5),
        at(0.1),
        at(0.9),
        sorted.len()
    );
}

fn sheet(tiles: &[Rgb8]) -> Rgb8 {
    let (width, height) = (tiles[0].width(), tiles[0].height());
    let rows = tiles.len().div_ceil(COLUMNS);
    Rgb8::from_fn(COLUMNS * (width + 2), rows * (height + 2), |x, y| {
        let (column, row) = (x / (width + 2), y / (height + 2));
        let (x, y) = (x % (width + 2), y % (height + 2));
        match tiles.get(COLUMNS * row + column) {
            Some(tile) if x < width && y < tile.height() => tile.pixel(x, y),
            _ => [255; 3],
        }
    })
}
