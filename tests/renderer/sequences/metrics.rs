//! Metrics along a path: independent of the order of frames, and plausible in clear water.

use renderer::{SceneSource, Slot};
use serde_json::{Value, json};

use super::describe;
use crate::common::{engine_without_runtime, parse};

const FRAMES: u64 = 4;
const METRICS: [&str; 6] = [
    "features",
    "matches",
    "matches_correct",
    "matches_precision",
    "track_length",
    "pose_error_deg",
];

fn job(water: &Value) -> spec::Job {
    let camera = json!({"width": 320, "height": 240, "path": {"frames": 24, "sway_m": 0.02}});
    let wide = json!({"method": "hscm", "name": "wide", "cutoff": 16});
    let metrics: Vec<&str> = METRICS.into_iter().chain(["illumination_residual"]).collect();
    let fields = json!({"count": 24, "artifacts": ["rgb"], "metrics": metrics, "enhance": ["clahe", wide], "water": water});
    parse(&describe(&camera, &fields))
}

fn measure(slot: &mut Slot, job: &spec::Job, index: u64) -> Value {
    let frame = job.resolve(index).unwrap();
    let rendered = slot.render(&frame, &SceneSource::Local).unwrap();
    json!(rendered.record.measurements)
}

#[test]
fn metrics_of_a_path_do_not_depend_on_the_order_of_the_frames() {
    let job = job(&json!({"optics": "jerlov-1C"}));
    let fresh: Vec<Value> = (0..FRAMES)
        .map(|index| measure(&mut Slot::new(&engine_without_runtime()), &job, index))
        .collect();
    for order in [[0, 1, 2, 3], [3, 1, 2, 0], [2, 3, 2, 1]] {
        let mut slot = Slot::new(&engine_without_runtime());
        for index in order {
            assert_eq!(
                measure(&mut slot, &job, index),
                fresh[index as usize],
                "{order:?}: {index}"
            );
        }
    }
    for subject in ["rgb", "clahe", "wide"] {
        let [first, second] = [0, 1].map(|index| fresh[index][subject].as_object().unwrap());
        // The first frame of a path has no previous one.
        assert!(
            first.contains_key("features") && !first.contains_key("matches"),
            "{subject}"
        );
        for metric in METRICS {
            assert!(second[metric].as_f64().unwrap().is_finite(), "{subject}.{metric}");
        }
    }
}

#[test]
fn most_matches_in_clear_water_are_correct_and_give_the_pose() {
    let values = measure(
        &mut Slot::new(&engine_without_runtime()),
        &job(&json!({"optics": "jerlov-I"})),
        2,
    );
    let of = |metric: &str| values["rgb"][metric].as_f64().unwrap();
    assert!(
        of("matches_correct") > 100.0 && of("matches_precision") > 0.5,
        "{values}"
    );
    assert!(of("track_length") > 0.3, "{values}");
    assert!(of("pose_error_deg") < 2.0, "{values}");
}
