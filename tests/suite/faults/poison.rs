//! Frames that crash or hang their worker. The comment above each test defines failure.

use fathom_tests::{Service, digest_by_render};
use serde_json::{Value, json};

fn job(frames: u64) -> Value {
    json!({
        "dataset": "poison", "count": frames, "seed": 3,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}},
        "camera": {"width": 40, "height": 24, "hfov_deg": 80},
        "water": {"optics": "jerlov-3C"}
    })
}

/// Failure: the job does not end, a neighbor has no image, a poisoned frame is retried forever or given up without a
/// reason, or the service crashes.
#[test]
fn poisoned_frames_are_given_up_with_their_reason_and_their_neighbors_finish() {
    let data = tempfile::tempdir().expect("a temporary folder");
    let poison = "frame=panic#3,frame=abort#11,frame=hang#17,frame=memory#23,scene.nan=flag#29";
    let environment = [
        ("FATHOM_FAULTS", poison),
        ("FATHOM_FRAME_LIMIT_S", "2"),
        ("FATHOM_MEMORY_LIMIT_MIB", "400"),
    ];
    let service = Service::start_with(data.path(), &["--workers", "2", "--slots", "1"], &environment);
    let id = service.submit(&job(40));
    let done = service.finished(&id);
    let counts = (done["done"].as_u64(), done["failed"].as_u64());
    assert_eq!(
        (done["state"].as_str(), counts),
        (Some("done_with_failures"), (Some(35), Some(5))),
        "{done}"
    );

    let (status, errors) = service.get_bytes(&format!("/v1/jobs/{id}/errors"));
    assert_eq!(status, 200);
    let errors = String::from_utf8(errors).expect("text");
    let errors: Vec<Value> = errors
        .lines()
        .map(|line| serde_json::from_str(line).expect("NDJSON"))
        .collect();
    let reason = |frame: u64| {
        let row = errors.iter().find(|row| row["frame"] == frame);
        row.unwrap_or_else(|| panic!("no error of frame {frame}: {errors:?}"))["error"].to_string()
    };
    for (frame, part) in [
        (3, "broken on purpose"),
        (11, "worker"),
        (17, "took more than 2 s, its time limit"),
        (23, "may take 400"),
        (29, "NaN"),
    ] {
        assert!(
            reason(frame).contains(part),
            "frame {frame} was given up with: {}",
            reason(frame)
        );
    }
    assert_eq!(errors.len(), 5, "{errors:?}");
    let late = errors
        .iter()
        .find(|row| row["frame"] == 17)
        .expect("checked above");
    assert_eq!(
        late["strikes"], 1,
        "a frame beyond its time limit is not tried again: {late}"
    );
    let (_, page) = service.get("/v1/images?dataset=poison&limit=100&fields=frame&order_by=frame");
    let frames: Vec<u64> = page["items"]
        .as_array()
        .expect("rows")
        .iter()
        .filter_map(|row| row["frame"].as_u64())
        .collect();
    let expected: Vec<u64> = (0..40)
        .filter(|frame| ![3, 11, 17, 23, 29].contains(frame))
        .collect();
    assert_eq!(frames, expected);
}

/// Failure: failed frames cannot be retried after the cause is fixed, or the digest then differs.
#[test]
fn what_failed_can_be_tried_again_after_the_cause_is_gone() {
    let data = tempfile::tempdir().expect("a temporary folder");
    let job = job(12);
    let expected = digest_by_render(&job, data.path(), "2");
    let id = {
        let faults = [("FATHOM_FAULTS", "scene.nan=flag#2/5")];
        let service = Service::start_with(data.path(), &["--workers", "1", "--slots", "2"], &faults);
        let id = service.submit(&job);
        let done = service.finished(&id);
        assert_eq!(
            (done["state"].as_str(), done["failed"].as_u64()),
            (Some("done_with_failures"), Some(2)),
            "{done}"
        );
        id
    };
    let service = Service::start(data.path(), &["--workers", "1", "--slots", "2"]);
    let (status, body) = service.post(&format!("/v1/jobs/{id}/retry-failed"), &json!({}));
    assert_eq!(status, 200, "{body}");
    let done = service.finished(&id);
    assert_eq!(
        (done["state"].as_str(), done["failed"].as_u64()),
        (Some("done"), Some(0)),
        "{done}"
    );
    assert_eq!(done["digest"], expected);
}
