//! The same job yields the same bytes with any renderer and any interruptions.
//!
//! Failure: any difference in the digest over frames, artifact digests and resolved parameters; a missing or duplicate
//! frame; a job that does not end.

use std::time::{Duration, Instant};

use fathom_tests::{Service, Worker, digest_by_render};
use serde_json::{Value, json};

const FRAMES: u64 = 60;

/// Every stage that could depend on the renderer: scene, water, style, haze, enhancement, metrics.
fn job() -> Value {
    json!({
        "dataset": "same-bytes", "count": FRAMES, "seed": 11,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 1000]}},
        "camera": {"width": 197, "height": 131, "hfov_deg": 70},
        "water": {
            "optics": {"choice": ["jerlov-IB", "jerlov-3C", "jerlov-9C"]},
            "range_scale": {"uniform": [0.5, 2.0]},
            "style": {"choice": ["atlantic", "mediterranean", "muddy"]}
        },
        "alpha": {"uniform": [0.0, 1.0]},
        "lights": [{"kind": "haze", "x": {"uniform": [0, 1]}, "y": 1.0, "size": 0.2,
                    "intensity": {"normal": [0.8, 0.1], "clip": [0, 1]}, "color": [1, 1, 1]}],
        "enhance": ["hscm"],
        "artifacts": ["rgb", "range", "scattered", "enhanced.hscm"]
    })
}

fn digest_of(service: &Service, id: &str) -> String {
    let done = service.finished(id);
    assert_eq!(done["state"], "done", "{done}");
    assert_eq!(done["done"], FRAMES);
    let (status, page) = service.get("/v1/images?dataset=same-bytes&limit=1000&fields=frame&order_by=frame");
    assert_eq!(status, 200, "{page}");
    let frames: Vec<u64> = page["items"]
        .as_array()
        .expect("rows")
        .iter()
        .filter_map(|row| row["frame"].as_u64())
        .collect();
    assert_eq!(frames, (0..FRAMES).collect::<Vec<_>>());
    done["digest"]
        .as_str()
        .expect("a finished job has a digest")
        .to_owned()
}

fn temporary() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

#[test]
fn one_slot_three_slots_two_workers_with_a_kill_and_no_service_agree() {
    let folder = temporary();
    let expected = digest_by_render(&job(), folder.path(), "2");

    for slots in ["1", "3"] {
        let data = temporary();
        let service = Service::start(data.path(), &["--workers", "1", "--slots", slots]);
        let id = service.submit(&job());
        assert_eq!(
            digest_of(&service, &id),
            expected,
            "one worker child of {slots} slots"
        );
    }

    let data = temporary();
    let service = Service::start(data.path(), &["--workers", "0"]);
    let first = Worker::start(&service.url, "first", 1);
    let second = Worker::start(&service.url, "second", 1);
    let id = service.submit(&job());
    wait_until_half_done(&service, &id);
    first.kill();
    assert_eq!(
        digest_of(&service, &id),
        expected,
        "two workers, one of them killed in the middle"
    );
    drop(second);
}

fn wait_until_half_done(service: &Service, id: &str) {
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_secs(120) {
        let (_, body) = service.get(&format!("/v1/jobs/{id}"));
        let done = body["done"].as_u64().unwrap_or_default();
        assert!(
            done < FRAMES,
            "the job ended before a worker could be killed in its middle"
        );
        if done >= FRAMES / 4 {
            return;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("the workers do not render");
}

#[test]
fn a_frame_rendered_alone_is_the_frame_of_the_whole_job() {
    let service_data = temporary();
    let service = Service::start(service_data.path(), &["--workers", "1", "--slots", "2"]);
    let mut short = job();
    short["count"] = json!(7);
    let id = service.submit(&short);
    assert_eq!(service.finished(&id)["state"], "done");
    let mut long = job();
    long["count"] = json!(9);
    let longer = service.submit(&long);
    assert_eq!(service.finished(&longer)["state"], "done");
    for frame in 0..7 {
        let bytes = |id: &str| service.get_bytes(&format!("/v1/images/{id}/{frame}/artifacts/rgb"));
        assert_eq!(
            bytes(&id),
            bytes(&longer),
            "frame {frame} changed when the job grew"
        );
    }
}
