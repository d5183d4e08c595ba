//! Every shipped example and site meets its tolerance.

use std::path::PathBuf;

use optics::plan::StageId;
use renderer::{SceneSource, Slot};
use serde_json::{Value, json};
use spec::SITES;

use crate::common::{engine_without_runtime, parse};

/// Frames of each job, enough for every choice and most weather of a site.
const FRAMES: u64 = 24;
/// Columns and rows of small frames.
const SMALL: (u64, u64) = (192, 123);

/// A job with its name in failure messages.
struct Shipped {
    name: String,
    job: Value,
}

fn examples() -> Vec<Shipped> {
    let folder = fathom_tests::root().join("examples");
    let entries = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let files = entries.filter(|path| path.extension().is_some_and(|ending| ending == "json"));
    let read = |path: PathBuf| Shipped {
        name: path.display().to_string(),
        job: serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap(),
    };
    files.map(read).collect()
}

fn sites() -> impl Iterator<Item = Shipped> {
    SITES.iter().map(|site| Shipped {
        name: site.name.to_owned(),
        job: json!({"site": site.name, "count": FRAMES}),
    })
}

fn examples_and_sites() -> Vec<Shipped> {
    let examples = examples();
    assert!(examples.len() >= 5, "{} examples", examples.len());
    examples.into_iter().chain(sites()).collect()
}

#[test]
fn no_example_or_site_exceeds_its_tolerance_at_its_size() {
    let mut slot = Slot::new(&engine_without_runtime());
    for Shipped { name, job } in examples_and_sites() {
        let job = parse(&job);
        for index in 0..FRAMES.min(job.frames()) {
            let plan = slot
                .plan(&job.resolve(index).unwrap(), &SceneSource::Local)
                .unwrap();
            let promise = plan.promise().unwrap();
            assert_eq!(promise.exceeds, None, "{name} frame {index}");
        }
    }
}

/// Lamps near a wall in bright daylight: the usual shares of all stages add up to more than the tolerance. Rounding of lamps usually has
/// an eighth of it.
#[test]
fn stages_are_more_accurate_before_a_frame_exceeds_its_tolerance() {
    let mut slot = Slot::new(&engine_without_runtime());
    let tolerance = 2e-4;
    let job =
        parse(&json!({"site": "harbour-wall", "seed": 2, "count": 10, "fidelity": {"tolerance": tolerance}}));
    let plan = slot.plan(&job.resolve(4).unwrap(), &SceneSource::Local).unwrap();
    let promise = plan.promise().unwrap();
    assert_eq!(promise.exceeds, None);
    let lamps = plan.stage(StageId::Lamps).and_then(|stage| stage.share).unwrap();
    let share = lamps * plan.stage(StageId::Exposure).unwrap().gain.absolute / tolerance;
    assert!((1.0 / 18.0..1.0 / 14.0).contains(&share), "{share}");
}

#[test]
fn a_small_frame_of_each_example_and_site_keeps_its_promise() {
    let mut slot = Slot::new(&engine_without_runtime());
    for Shipped { name, mut job } in examples_and_sites() {
        (job["camera"]["width"], job["camera"]["height"]) = (json!(SMALL.0), json!(SMALL.1));
        job["artifacts"] = json!(["rgb"]);
        job["enhance"] = json!([]);
        job["metrics"] = json!([]);
        let frame = parse(&job).resolve(0).unwrap();
        let record = slot.render(&frame, &SceneSource::Local).unwrap().record;
        let promise = record.promise.unwrap();
        assert_eq!(promise.exceeds, None, "{name}");
        assert!(
            promise.bound > 0.0 && promise.bound <= promise.tolerance,
            "{promise:?}"
        );
        let planned = slot.plan(&frame, &SceneSource::Local).unwrap().promise().unwrap();
        assert_eq!(planned, promise, "{name}");
    }
}
