//! `fathom-lab look`: compares the frames of jobs with the look of underwater photographs.

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
    /// Name the frames that are outside of a range, with their values
    #[arg(long)]
    outside: bool,
    /// Where to write a sheet, a row for each job
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Longer side of a picture on the sheet
    #[arg(long, default_value_t = 400)]
    tile_width: usize,
}

/// Pictures per row of the sheet.
const COLUMNS: usize = 3;

/// A statistic, its range in photographs, and the frames it applies to.
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
        applies: is_day,
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

/// Whether a job has daylight.
fn is_day(job: &Value) -> bool {
    match job.get("daylight") {
        Some(daylight) => daylight.is_object(),
        None => job.get("lights").is_none() || job.pointer("/water/depth_m").is_some(),
    }
}

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
            let outside = arguments.outside.then(|| outside(row, &looks)).flatten();
            line(row, &values)
                .into_iter()
                .chain(outside)
                .for_each(|line| println!("{line}"));
            all.extend(values);
        }
    }
    println!("all");
    for (row, values) in ROWS.iter().zip(&all) {
        line(row, values).iter().for_each(|line| println!("{line}"));
    }
    match &arguments.out {
        Some(path) => files::write_picture(path, &sheet(&tiles).into()),
        None => Ok(()),
    }
}

/// Formats the median, the 10th and 90th percentile, and the counts within, below and above the range of photographs. `None` without
/// values.
fn line(row: &Row, values: &[f64]) -> Option<String> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    let at = |share: f64| sorted[(share * last as f64).round() as usize];
    let [low, high] = row.range;
    let below = sorted.iter().filter(|&&v| v < low).count();
    let above = sorted.iter().filter(|&&v| v > high).count();
    let outside = match below + above {
        0 => String::new(),
        _ => format!(", {below} below, {above} above"),
    };
    Some(format!(
        "  {:<44} {:>7.2} ({:.2} to {:.2}), wanted {low} to {high}: {} of {}{outside}",
        row.name,
        at(0.5),
        at(0.1),
        at(0.9),
        sorted.len() - below - above,
        sorted.len()
    ))
}

/// Frames outside the range of photographs, for each statistic.
fn outside(row: &Row, looks: &[Look]) -> Option<String> {
    let frames = looks.iter().enumerate().filter_map(|(frame, look)| {
        let value = (row.of)(look)?;
        let is_within = (row.range[0]..=row.range[1]).contains(&value);
        (!is_within).then(|| format!("{frame} ({value:.2})"))
    });
    let frames: Vec<String> = frames.collect();
    (!frames.is_empty()).then(|| format!("    frames {}", frames.join(", ")))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_on_which_side_frames_are_outside() {
        let entropy = &ROWS[3];
        let seen = line(entropy, &[7.5, 6.0, 5.0, 5.6, 7.0]).unwrap_or_default();
        assert!(
            seen.ends_with("6.00 (5.00 to 7.50), wanted 5.6 to 6.9: 2 of 5, 1 below, 2 above"),
            "{seen}"
        );
        assert!(line(entropy, &[6.0]).is_some_and(|line| line.ends_with("1 of 1")));
        assert_eq!(line(entropy, &[]), None);
    }
}
