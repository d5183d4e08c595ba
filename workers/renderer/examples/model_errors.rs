//! Distance of the light of frames from its truth, for the table of model errors.
//!
//! ```sh
//! cargo run --release -p renderer --example model_errors -- 6 > errors.csv
//! ```
//!
//! The argument is the number of frames of each case: the sites with a truth, and plain jobs in six waters by night with two spots, by
//! day, and by day with two spots; further arguments select cases by the beginning of their names. Prints one line of comma-separated
//! text for each frame. Pictures of 64x41, two threads.

use std::sync::Arc;
use std::thread;

use renderer::{ComparableFrame, Content, Engine, SceneSource, Slot};
use serde_json::{Map, Value, json};
use spec::{ArtifactKind, Frame, Job};
use style::Library;

const SIZE: (usize, usize) = (64, 41);
const WATERS: [&str; 6] = [
    "jerlov-IB",
    "jerlov-II",
    "jerlov-III",
    "jerlov-1C",
    "jerlov-3C",
    "jerlov-5C",
];
const TARGET: f64 = 0.02;
const MOST_PATHS: u64 = 512;

/// Sites whose light has a truth.
const SITES: [&str; 6] = [
    "harbour-wall",
    "lock-chamber",
    "pile-in-current",
    "pipeline",
    "shaft",
    "tank",
];

fn main() {
    let mut arguments = std::env::args().skip(1);
    let count = arguments.next().and_then(|text| text.parse().ok()).unwrap_or(6);
    let wanted: Vec<String> = arguments.collect();
    let library = Library::embedded().expect("the embedded style models");
    let vocabulary = renderer::vocabulary(&library, false);
    let mut slot = Slot::new(&Arc::new(Engine::new(library, None)));
    println!("case,frame,light,a,b,least_decay,most_decay,range_m,bias,rms,noise");
    let cases = list_cases(count);
    for (name, job) in cases.iter().filter(|(name, _)| is_wanted(name, &wanted)) {
        let job = Job::parse(job.to_string().as_bytes(), &vocabulary).expect("a valid job");
        for index in 0..job.frames() {
            let frame = job.resolve(index).expect("a frame of the job");
            println!("{name},{index},{}", measure(&mut slot, &frame));
        }
    }
}

/// Whether a case was selected; all are without a selection.
fn is_wanted(name: &str, wanted: &[String]) -> bool {
    wanted.is_empty() || wanted.iter().any(|start| name.starts_with(start))
}

/// The cases by name.
fn list_cases(count: u64) -> Vec<(String, Value)> {
    let camera = json!({"width": SIZE.0, "height": SIZE.1});
    let sites = SITES.iter().map(|site| {
        let job = json!({"site": site, "count": count, "seed": 23, "camera": camera});
        ((*site).to_owned(), job)
    });
    let lights = ["night", "day", "both"];
    let plain = WATERS
        .iter()
        .flat_map(|water| lights.map(|light| (format!("{water} {light}"), plain_job(water, light, count))));
    sites.chain(plain).collect()
}

/// Frames with surfaces at all angles and distances.
fn plain_job(water: &str, light: &str, count: u64) -> Value {
    let families = if light == "night" {
        json!(["structure", "pipeline", "shaft"])
    } else {
        json!(["structure", "pipeline", "open-water"])
    };
    let mut job = json!({
        "count": count,
        "seed": 23,
        "scene": {"kind": "procedural", "family": {"grid": families}, "seed": {"int": [0, 1000]}},
        "water": {"optics": water},
        "camera": {"width": SIZE.0, "height": SIZE.1},
    });
    job["count"] = json!(count.div_ceil(3));
    if light != "day" {
        job["lights"] = json!([describe_spot(-1.0), describe_spot(1.0)]);
    }
    if light != "night" {
        job["water"]["depth_m"] = json!({"uniform": [2, 8]});
        job["daylight"] =
            json!({"sun_elevation_deg": {"uniform": [25, 70]}, "cloud_cover": {"uniform": [0.1, 0.9]}});
    }
    job
}

/// A spot on one side of the camera.
fn describe_spot(side: f64) -> Value {
    json!({
        "kind": "spot",
        "position_m": [side * 0.4, -0.3, 0],
        "direction": [-side * 0.15, 0.05, 1],
        "intensity": [4, 4, 4],
        "cone_deg": {"uniform": [20, 90]},
    })
}

/// The numbers of a frame.
fn measure(slot: &mut Slot, frame: &Frame) -> String {
    let comparable = ComparableFrame::new(frame, SIZE).expect("a procedural scene");
    let pixels = SIZE.0 * SIZE.1;
    let truth = slot.trace_truth(&comparable, TARGET, MOST_PATHS, &mut |batch, scene, samples| {
        let sums = thread::scope(|scope| {
            let half = scope.spawn(|| batch.trace(scene, 0..pixels / 2, samples));
            let mut rest = batch.trace(scene, pixels / 2..pixels, samples);
            let mut sums = half.join().expect("a traced half");
            sums.append(&mut rest);
            sums
        });
        Some(sums)
    });
    let truth = truth.expect("a truth").expect("a first round");
    let distance = slot.measure_distance(&comparable, &truth).expect("light");
    let mut whole = comparable.frame.clone();
    whole.artifacts = vec![ArtifactKind::parse("range").expect("an artifact")];
    let contents = slot.contents(&whole, &SceneSource::Local).expect("a frame");
    let optics = &contents.record.optics;
    let (a, b) = (
        read_channels(optics, "absorption_per_m"),
        read_channels(optics, "scattering_per_m"),
    );
    let most = (0..3)
        .max_by(|&one, &other| b[one].total_cmp(&b[other]))
        .unwrap_or(0);
    let depth = frame.water.depth_m.unwrap_or(f64::NAN);
    let decays = read_channels(optics, "diffuse_attenuation_per_m").map(|decay| decay * depth);
    let least = decays.into_iter().fold(f64::INFINITY, f64::min);
    let greatest = decays.into_iter().fold(0.0, f64::max);
    let light = match (frame.has_lamps(), depth.is_nan()) {
        (true, true) => "night",
        (true, false) => "both",
        (false, _) => "day",
    };
    let numbers = [distance.bias, distance.rms, truth.noise];
    let numbers = numbers.map(|number| format!("{number:.4}")).join(",");
    let range = typical_range(&contents.artifacts[0].1);
    format!(
        "{light},{:.4},{:.4},{least:.3},{greatest:.3},{range:.2},{numbers}",
        a[most], b[most]
    )
}

/// A coefficient of a record, 1/m.
fn read_channels(optics: &Map<String, Value>, name: &str) -> [f64; 3] {
    [0, 1, 2].map(|i| {
        let value = optics.get(name).and_then(|values| values[i].as_f64());
        value.unwrap_or(f64::NAN)
    })
}

/// The range that 95 % of the surfaces are within, m.
fn typical_range(content: &Content<'_>) -> f32 {
    let Content::Range(range) = content else {
        return f32::NAN;
    };
    let mut meters: Vec<f32> = range
        .data()
        .iter()
        .copied()
        .filter(|z| z.is_finite() && *z > 0.0)
        .collect();
    meters.sort_by(f32::total_cmp);
    let last = (0.95 * meters.len() as f32) as usize;
    meters
        .get(last.min(meters.len().saturating_sub(1)))
        .copied()
        .unwrap_or(f32::NAN)
}
