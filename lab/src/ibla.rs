//! The faster variant of IBLA against the exact one, picture by picture: agreement of the candidates for background light, and
//! difference of the results.

use cli::exit::Failure;
use cli::progress::Progress;
use enhance::ibla::{IblaRefinement, candidates};
use enhance::{EnhanceError, Variant, run as enhance};
use imaging::{Raster, Rgb8, transfer};
use serde_json::json;

use crate::measurement::{difference, time_once};
use crate::report::Report;
use crate::row;
use crate::setup::{Parameter, Setup};
use crate::statistics::sorted;
use crate::studio::{Studio, raster, read_json};
use crate::table::Table;

/// The parameters of the comparison.
pub const PARAMETERS: &[Parameter] = &[
    Parameter::number("frames", "16", [1.0, 1e5], "frames of each job"),
    Parameter::number(
        "width",
        "869",
        [16.0, 4096.0],
        "columns of the frames; rows follow as 565 to 869",
    ),
];
/// Maximum difference of a channel for candidates to count as equal, in 0..=1.
const SAME: f64 = 0.01;

/// One variant on one picture.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Outcome {
    form: IblaRefinement,
    /// Largest difference of a candidate's channel from the exact variant, 0..=1.
    apart: f64,
    /// Root mean square difference of the results in linear light, 0..=1.
    distance: f64,
    /// Milliseconds of the method.
    ms: f64,
}

impl Outcome {
    /// Whether the candidates equal those of the exact variant.
    fn is_kept(&self) -> bool {
        self.apart <= SAME
    }
}

/// Compares the variants on frames of jobs.
///
/// # Errors
/// A job cannot be read or rendered.
pub fn run(setup: &Setup) -> Result<Report, Failure> {
    let jobs = setup.required_inputs("jobs")?;
    let (frames, width) = (setup.count("frames") as u64, setup.count("width"));
    let mut studio = Studio::new(&setup.styles)?;
    let mut progress = Progress::new("ibla", "frames", frames * jobs.len() as u64);
    let mut outcomes = Vec::new();
    for path in jobs {
        let mut job = read_json(path)?;
        for (key, value) in [
            ("artifacts", json!(["rgb"])),
            ("count", json!(frames)),
            ("enhance", json!([])),
            ("metrics", json!([])),
        ] {
            job[key] = value;
        }
        // The light is estimated before a style, which would need ONNX Runtime.
        job["water"].as_object_mut().map(|water| water.remove("style"));
        job.as_object_mut().map(|job| job.remove("alpha"));
        job["camera"]["width"] = json!(width);
        job["camera"]["height"] = json!((width * 565 / 869).max(1));
        for index in 0..frames {
            let frame = studio.frame(&job, index)?;
            let picture = raster(&studio.render(&frame)?, "rgb")?.to_rgb8();
            outcomes.extend(compare(&picture).map_err(anyhow::Error::from)?);
            progress.set(outcomes.len() as u64 / 2);
        }
    }
    progress.finish();
    let about = format!(
        "{} frames of {width} columns, without styles.",
        outcomes.len() / 2
    );
    Ok(Report::new(about, vec![table(&outcomes)]))
}

/// Runs all variants on a picture, the exact one first.
fn compare(picture: &Rgb8) -> Result<[Outcome; 2], EnhanceError> {
    let source = Raster::from(picture.clone());
    let mut results = Vec::new();
    for form in IblaRefinement::ALL {
        let mut enhanced = None;
        let ms = time_once(|| enhanced = Some(enhance(&form.method(), &source)));
        let codes = enhanced.expect("it was run")?.picture.to_rgb8();
        results.push((ms, transfer::decode_rgb8(&codes)));
    }
    let found = IblaRefinement::ALL.map(|form| candidates(picture, form, Variant::Fast));
    Ok(std::array::from_fn(|n| Outcome {
        form: IblaRefinement::ALL[n],
        apart: find_distance(&found[n], &found[0]),
        distance: difference(&results[n].1, &results[0].1).rmse,
        ms: results[n].0,
    }))
}

fn find_distance(got: &[[f64; 3]; 3], expected: &[[f64; 3]; 3]) -> f64 {
    let pairs = got.as_flattened().iter().zip(expected.as_flattened());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// A row for each variant.
fn table(outcomes: &[Outcome]) -> Table {
    let columns = [
        "variant",
        "pictures",
        "same candidates, %",
        "distance: median",
        "95th percentile",
        "largest",
        "ms: least",
        "median",
    ];
    let mut table = Table::new("variants", columns);
    for form in IblaRefinement::ALL {
        let own: Vec<&Outcome> = outcomes.iter().filter(|outcome| outcome.form == form).collect();
        if own.is_empty() {
            continue;
        }
        let kept = own.iter().filter(|outcome| outcome.is_kept()).count();
        let distances = sorted(own.iter().map(|outcome| outcome.distance));
        let times = sorted(own.iter().map(|outcome| outcome.ms));
        table.push(row![
            form.name(),
            own.len(),
            100.0 * kept as f64 / own.len() as f64,
            upper_quantile(&distances, 0.5),
            upper_quantile(&distances, 0.95),
            upper_quantile(&distances, 1.0),
            upper_quantile(&times, 0.0),
            upper_quantile(&times, 0.5),
        ]);
    }
    table
}

/// The smallest of the sorted values that is an upper bound for this share of them.
fn upper_quantile(sorted: &[f64], share: f64) -> f64 {
    let place = (share * sorted.len() as f64).ceil() as usize;
    sorted[place.saturating_sub(1)]
}

#[cfg(test)]
mod tests;
