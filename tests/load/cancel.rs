//! Cancellation of frames being rendered. The comment above each test defines failure.

use std::time::{Duration, Instant};

use fathom_tests::Service;
use serde_json::{Value, json};

/// From the cancellation to the end of a small frame in the same slot. On an idle machine it takes a few hundred
/// milliseconds.
const SOON: Duration = Duration::from_secs(5);
/// The same if the process must be killed and restarted.
const ENDED: Duration = Duration::from_secs(15);

fn small(seed: u64) -> Value {
    json!({
        "dataset": "small", "count": 1, "seed": seed,
        "scene": {"kind": "procedural", "family": "structure", "seed": 1},
        "camera": {"width": 32, "height": 20, "hfov_deg": 80}
    })
}

/// Frames that take tens of seconds to minutes, each in another stage.
fn long() -> Vec<(&'static str, Value)> {
    let frame = |(width, height): (u32, u32), more: Value| {
        let mut job = json!({
            "dataset": "long", "count": 2,
            "scene": {"kind": "procedural", "family": "pipeline", "seed": 1},
            "camera": {"width": width, "height": height, "hfov_deg": 80}
        });
        for (name, value) in more.as_object().expect("an object") {
            job[name] = value.clone();
        }
        job
    };
    let lamp = json!({"kind": "point", "position_m": [0.3, 0, 0], "intensity": [1, 1, 1]});
    let lamps = vec![lamp; 16];
    vec![
        ("scene", frame((8000, 8000), json!({}))),
        (
            "kernels",
            frame(
                (8000, 8000),
                json!({"water": {"optics": "jerlov-9C"}, "artifacts": ["rgb"]}),
            ),
        ),
        (
            "reference water",
            frame(
                (256, 200),
                json!({"fidelity": "reference", "water": {"optics": "jerlov-3C"}}),
            ),
        ),
        (
            "reference lamps",
            frame(
                (256, 250),
                json!({"fidelity": "reference", "water": {"optics": "jerlov-3C"}, "lights": lamps}),
            ),
        ),
        (
            "enhancements",
            frame(
                (4000, 4000),
                json!({"enhance": ["hscm", "ibla", "suir"], "metrics": ["uiqm", "uciqe"]}),
            ),
        ),
    ]
}

/// Cancels or deletes a job whose first frame is being rendered; returns the time until the slot has finished a small
/// frame.
fn freed_after(service: &Service, job: &Value, seed: u64, end: impl Fn(&str)) -> Duration {
    let id = service.submit(job);
    let begun = Instant::now();
    let is_leased = || service.get("/v1/workers").1["items"][0]["leased_frames"].as_u64() > Some(0);
    while !is_leased() {
        assert!(
            begun.elapsed() < Duration::from_secs(60),
            "no worker took the frame"
        );
        std::thread::sleep(Duration::from_millis(20));
    }
    // Well into the frame.
    std::thread::sleep(Duration::from_millis(1500));
    assert!(is_leased(), "the frame was too quick to be cancelled: {job}");
    let ended = Instant::now();
    end(&id);
    let small = service.submit(&small(seed));
    assert_eq!(service.finished(&small)["state"], "done");
    ended.elapsed()
}

/// Failure: a slot continues a cancelled frame; the next frame has other bytes.
#[test]
fn a_cancelled_or_deleted_jobs_frame_ends_at_once() {
    let data = tempfile::tempdir().expect("a temporary folder");
    let service = Service::start(data.path(), &["--workers", "1", "--slots", "1"]);
    let first = service.submit(&small(1));
    let picture = |id: &str| service.get_bytes(&format!("/v1/images/{id}/0/artifacts/rgb"));
    assert_eq!(service.finished(&first)["state"], "done");
    let expected = picture(&first);
    let cancel = |id: &str| assert_eq!(service.post(&format!("/v1/jobs/{id}/cancel"), &json!({})).0, 200);
    let delete = |id: &str| assert_eq!(service.delete(&format!("/v1/jobs/{id}")).0, 200);
    for ((stage, job), seed) in long().into_iter().zip(2..) {
        let after = freed_after(&service, &job, seed, cancel);
        println!(
            "{stage}: the slot was free and the next frame done {:.2} s after the cancel",
            after.as_secs_f64()
        );
        assert!(after < SOON, "{stage}: {after:?}");
    }
    let (stage, job) = &long()[2];
    let after = freed_after(&service, job, 100, delete);
    println!("{stage}: {:.2} s after the deletion", after.as_secs_f64());
    assert!(after < SOON, "{stage}: {after:?}");
    let mut again = small(1);
    again["dataset"] = json!("again");
    let again = service.submit(&again);
    assert_eq!(service.finished(&again)["state"], "done");
    assert_eq!((expected.0, picture(&again)), (200, expected));
}

/// Failure: a frame that never checks its flag keeps its slot for more than 10 s, or a neighbor receives a strike.
#[test]
fn a_frame_that_does_not_look_is_ended_with_its_process() {
    let data = tempfile::tempdir().expect("a temporary folder");
    let faults = [("FATHOM_FAULTS", "frame=hang#1")];
    let service = Service::start_with(data.path(), &["--workers", "1", "--slots", "1"], &faults);
    let mut job = small(1);
    job["count"] = json!(2);
    let after = freed_after(&service, &job, 2, |id| {
        assert_eq!(service.post(&format!("/v1/jobs/{id}/cancel"), &json!({})).0, 200);
    });
    println!(
        "a frame that hangs: {:.2} s after the cancel",
        after.as_secs_f64()
    );
    assert!(after < ENDED, "{after:?}");
}
