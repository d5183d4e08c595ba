//! Named kill points, and the job that runs meanwhile.

use serde_json::{Value, json};

/// Frames of [`small_job`].
pub const SMALL_JOB_FRAMES: u64 = 40;

/// All kill points of the service, its store and its catalogue.
pub const SERVICE_POINTS: [&str; 11] = [
    "submit.checked",
    "submit.inserted",
    "lease.granted",
    "artifacts.received",
    "pack.written",
    "pack.committed",
    "artifacts.stored",
    "commit.begun",
    "catalogue.written",
    "catalogue.committed",
    "commit.inserted",
];

/// A job of small frames in two waters, with a picture and a range each.
#[must_use]
pub fn small_job(dataset: &str) -> Value {
    json!({
        "dataset": dataset, "count": SMALL_JOB_FRAMES, "seed": 11,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}},
        "camera": {"width": 40, "height": 24, "hfov_deg": 80},
        "water": {"optics": {"choice": ["jerlov-IB", "jerlov-5C"]}},
        "artifacts": ["rgb", "range"]
    })
}
