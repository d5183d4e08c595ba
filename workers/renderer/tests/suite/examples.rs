//! Every shipped example meets its tolerance.

use std::path::{Path, PathBuf};

use renderer::{SceneSource, Slot};
use serde_json::{Value, json};

use crate::common::{engine_without_runtime, parse};

/// Frames of each example.
const FRAMES: u64 = 2;
/// Columns and rows of small frames.
const SMALL: (u64, u64) = (192, 123);

fn examples() -> Vec<(PathBuf, Value)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let entries = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let jobs = entries.filter(|path| path.extension().is_some_and(|ending| ending == "json"));
    let read = |path: PathBuf| {
        let job = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        (path, job)
    };
    jobs.map(read).collect()
}

#[test]
fn no_example_exceeds_its_tolerance_at_its_size() {
    let mut slot = Slot::new(&engine_without_runtime());
    let examples = examples();
    assert!(examples.len() >= 10, "{} examples", examples.len());
    for (path, job) in examples {
        let job = parse(&job);
        for index in 0..FRAMES {
            let plan = slot
                .plan(&job.resolve(index).unwrap(), &SceneSource::Local)
                .unwrap();
            let promise = plan.promise().unwrap();
            assert_eq!(promise.exceeds, None, "{} frame {index}", path.display());
        }
    }
}

#[test]
fn a_small_frame_of_each_example_keeps_its_promise() {
    let mut slot = Slot::new(&engine_without_runtime());
    for (path, mut job) in examples() {
        (job["camera"]["width"], job["camera"]["height"]) = (json!(SMALL.0), json!(SMALL.1));
        job["artifacts"] = json!(["rgb"]);
        job["enhance"] = json!([]);
        job["metrics"] = json!([]);
        let frame = parse(&job).resolve(0).unwrap();
        let record = slot.render(&frame, &SceneSource::Local).unwrap().record;
        let promise = record.promise.unwrap();
        assert_eq!(promise.exceeds, None, "{}", path.display());
        assert!(
            promise.bound > 0.0 && promise.bound <= promise.tolerance,
            "{promise:?}"
        );
        let planned = slot.plan(&frame, &SceneSource::Local).unwrap().promise().unwrap();
        assert_eq!(planned, promise, "{}", path.display());
    }
}
